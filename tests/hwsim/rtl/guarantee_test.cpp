#include <gtest/gtest.h>

#include "hwsim/circuit_port.h"
#include "tests/hwsim/judged_queries.h"

namespace hwsim {
namespace {

/// A stock in the circuit, by way of the driver, with the emulator beside it.
class CircuitStock {
public:
    explicit CircuitStock(const core::CutModel& stock)
        : device_(emulated_device({.elements = 2}).value()),
          driver_(open_device(port_with_circuit(device_, {}, difference_).value()).value()),
          stock_(load_stock(driver_, stock).value()) {}
    CircuitStock(const CircuitStock&) = delete;
    CircuitStock& operator=(const CircuitStock&) = delete;
    ~CircuitStock() { EXPECT_EQ(*difference_, ""); }

    bool refuses(const Question& q) {
        const SlotNumber tool = load_tool(driver_, q.body, 0.05).value();
        const double step = glm::length(q.to - q.from) / static_cast<double>(1U << q.log2_steps);
        const uint32_t asked = push(driver_, {.from = q.from,
                                              .to = q.to,
                                              .pairs = {{tool, stock_, q.allowance}},
                                              .sample_step = std::max(step, 1e-3)})
                                   .value();
        const DeviceReport answer = wait_for_all(driver_);
        unload(driver_, tool);
        const bool is_permitted = answer.permitted == asked;
        EXPECT_EQ(answer.stop == Stop::none, is_permitted);
        EXPECT_TRUE(is_permitted || answer.stop == Stop::violation) << name_of(answer.stop);
        if (!is_permitted) recover(driver_);
        return !is_permitted;
    }

private:
    EmulatedDevice device_;
    CircuitDifference difference_ = std::make_shared<std::string>();
    Driver driver_;
    SlotNumber stock_;
};

void expect_none_missed(uint32_t seed, const QueryKind& kind) {
    const JudgedQueries all = judged_queries_of<CircuitStock>(seed, kind);
    EXPECT_EQ(all.missed, 0) << all.first_missed;
    EXPECT_GT(all.violations, all.asked / 10);
    EXPECT_GT(all.asked - all.refused, all.asked / 10);
    EXPECT_LT(all.false_alarms, all.asked / 10);
}

TEST(CircuitGuarantee, Holds) {
    expect_none_missed(21, {.h = 1.0, .stocks = 5, .queries = 50});
    expect_none_missed(22, {.grid = 0.5, .h = 1.0, .stocks = 5, .queries = 50});
}

// 100,000 questions in all.

TEST(CircuitGuarantee, HoldsForLong) {
    expect_none_missed(23, {.h = 1.0, .stocks = 100, .queries = 500});
}

TEST(CircuitGuarantee, HoldsForLongOnACoarseLattice) {
    expect_none_missed(24, {.grid = 0.5, .h = 1.0, .stocks = 50, .queries = 500});
}

TEST(CircuitGuarantee, HoldsForLongOnTheLatticeOfTheDevice) {
    expect_none_missed(25, {.grid = lsb, .h = 0.75, .stocks = 50, .queries = 500});
}

} // namespace
} // namespace hwsim

#include <gtest/gtest.h>

#include "hwsim/coprocessor.h"
#include "hwsim/driver.h"

namespace hwsim {
namespace {

TEST(DriverSegment, SamplesAsDenselyAsRequestedAndNoDenser) {
    FunctionalDevice device = functional_device({.memory_lines = 64}).value();
    Driver driver = open_device(port_of(device)).value();
    const SlotNumber tool = load_records(driver, Side::tool, {{{0, 0, 0}, 0, 0}}).value();
    const SlotNumber work = load_records(driver, Side::work, {{{0, 0, 0}, 0, 0}}).value();
    for (const auto& [length, log2_steps] : {std::pair{0.0, 0U},
                                             {0.1, 0U},
                                             {0.101, 1U},
                                             {0.2, 1U},
                                             {0.21, 2U},
                                             {3.2, 5U},
                                             {3.3, 6U}}) {
        ASSERT_TRUE(push(driver, {{0, 0, 9}, {0, 0, 9 + length}, {{tool, work, 1.0}}, 0.1}));
        EXPECT_EQ(device.state.retired.segment.log2_steps, log2_steps) << length;
    }
}

TEST(DriverSegment, MeasuresTheNearestOfItsPairs) {
    FunctionalDevice device = functional_device({.memory_lines = 64}).value();
    Driver driver = open_device(port_of(device)).value();
    const SlotNumber tool = load_records(driver, Side::tool, {{{0, 0, 0}, 0, 0}}).value();
    std::vector<RequiredPair> pairs;
    for (const int32_t x : {300, 100, 200})
        pairs.push_back({tool, load_records(driver, Side::work, {{{x, 0, 0}, 0, 0}}).value(), 0.0});
    const auto nearest = measure(driver, {{0, 0, 0}, {0, 0, 0}, pairs}).value();
    ASSERT_TRUE(nearest);
    EXPECT_EQ(nearest->squared, 10'000U);
}

} // namespace
} // namespace hwsim

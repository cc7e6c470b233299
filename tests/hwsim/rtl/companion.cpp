// Devices of the tests get the circuit as a companion. A test with a device of sizes in which the
// circuit was not built is named below.

#include "tests/hwsim/companion.h"

#include <set>
#include <string>

#include "hwsim/rtl_device.h"

namespace hwsim::rtl {
namespace {

class CircuitCompanion : public Companion {
public:
    explicit CircuitCompanion(RtlDevice circuit) : circuit_(std::move(circuit)) {}

    void clock(CoprocessorState& emulated) override {
        circuit_.share(emulated.memory.lines, emulated.shared);
        circuit_.set_stalled(emulated.memory.stalled, emulated.ring.stalled);
        circuit_.clock();
        EXPECT_EQ(circuit_.cycle(), emulated.cycle);
        EXPECT_EQ(circuit_.interrupt(), interrupt(emulated)) << emulated.cycle;
        ++companion_cycles;
    }
    void write(uint32_t address, uint32_t value) override { circuit_.write(address, value); }
    uint32_t read(uint32_t address) override { return circuit_.read(address); }

    static inline uint64_t companion_cycles = 0;

private:
    RtlDevice circuit_;
};

/// Tests with a device of other sizes, which runs on the emulator alone: because they are about
/// sizes, or try random ones, of which some were built.
bool may_lack_a_circuit(const std::string& test) {
    static const std::set<std::string> names = {
        "Coprocessor.AnswersTheSameHoweverItIsBuilt",
        "Coprocessor.ForgetsLinesThatAreWrittenWhileTheyAreRead", "Fault.AFullStackStopsTheDevice",
        "Fault.AStackAsDeepAsTheSearchIsEnoughAndNoLess", "Ring.ReadsAheadAsFastAsTheHostAnswers"};
    return names.contains(test) || test.starts_with("DeviceSoak.")
           || test.starts_with("DriverFault");
}

std::unique_ptr<Companion> circuit_for(const DeviceConfig& config) {
    auto circuit = RtlDevice::with(config);
    if (circuit) return std::make_unique<CircuitCompanion>(*std::move(circuit));
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::string name = std::string(test->test_suite_name()) + "." + test->name();
    EXPECT_TRUE(may_lack_a_circuit(name)) << circuit.error().message;
    return nullptr;
}

[[maybe_unused]] const bool is_used = (make_companion = circuit_for, true);

/// So that the tests do not pass for want of companions.
class CompanionsAreUsed : public ::testing::Environment {
public:
    void TearDown() override { EXPECT_GT(CircuitCompanion::companion_cycles, 100'000U); }
};
[[maybe_unused]] auto* const environment =
    ::testing::AddGlobalTestEnvironment(new CompanionsAreUsed);

} // namespace
} // namespace hwsim::rtl

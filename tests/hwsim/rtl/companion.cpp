// Devices of the tests get the circuit as a companion, if it was built in their sizes.

#include "tests/hwsim/companion.h"

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

std::unique_ptr<Companion> circuit_for(const DeviceConfig& config) {
    auto circuit = RtlDevice::with(config);
    return circuit ? std::make_unique<CircuitCompanion>(*std::move(circuit)) : nullptr;
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

// The whole circuit, held against the emulator at every clock edge.

#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hwsim/circuit_port.h"
#include "hwsim/rtl_device.h"
#include "tests/hwsim/rtl/random_host.h"

namespace hwsim::rtl {
namespace {

/// All registers that can be read, counters included.
std::vector<uint32_t> all_addresses() {
    std::vector<uint32_t> addresses;
    for (uint32_t address = 0; address <= address_of(Register::ring_head); address += 4)
        addresses.push_back(address);
    for (uint32_t i = 0; i < 2 * counter_count + 2; ++i)
        addresses.push_back(address_of(Register::counter) + 4 * i);
    return addresses;
}

/// The device of a host that does anything, and the circuit beside it, with the same memories.
class DeviceLockstep {
public:
    explicit DeviceLockstep(uint32_t seed)
        : host_(seed), circuit_(RtlDevice::with(host_.device.config).value()) {
        circuit_.share(host_.device.state.memory.lines, host_.device.state.shared);
    }

    void step() {
        CoprocessorState& s = host_.device.state;
        const auto write = host_.act();
        if (write)
            circuit_.write(address_of(write->which), write->value);
        else
            expect_the_same_register();
        circuit_.set_stalled(s.memory.stalled, s.ring.stalled);
        circuit_.clock();
        const uint32_t permitted = s.permits.permit_sequence;
        host_.device.clock();
        permits += s.permits.permit_sequence - permitted;
        ASSERT_EQ(circuit_.cycle(), s.cycle);
        ASSERT_EQ(circuit_.interrupt(), interrupt(s)) << s.cycle;
    }

    const std::array<int, stop_count>& stops() const { return host_.stops; }
    size_t permits = 0;

private:
    /// One register after the other; now and then the bus rests.
    void expect_the_same_register() {
        if (rng_() % 10 == 0) rest_ = rng_() % 20;
        if (rest_ > 0) {
            --rest_;
            return;
        }
        CoprocessorState& s = host_.device.state;
        const uint32_t address = addresses_[next_++ % addresses_.size()];
        ASSERT_EQ(circuit_.read(address), hwsim::read(s, host_.device.config, address))
            << fmt::format("{:#x} in cycle {}", address, s.cycle);
    }

    RandomHost host_;
    RtlDevice circuit_;
    std::vector<uint32_t> addresses_ = all_addresses();
    size_t next_ = 0, rest_ = 0;
    std::mt19937 rng_{17};
};

TEST(DeviceCircuit, EqualsTheEmulatorWhateverTheHostDoes) {
    std::array<int, stop_count> stops{};
    size_t permits = 0;
    for (uint32_t seed = 0; seed < 20; ++seed) {
        DeviceLockstep both(seed);
        for (int cycle = 0; cycle < 100'000; ++cycle) {
            both.step();
            if (HasFatalFailure()) return;
        }
        permits += both.permits;
        for (size_t i = 0; i < stops.size(); ++i) stops[i] += both.stops()[i];
    }
    EXPECT_GT(permits, 5'000U);
    for (const Stop stop :
         {Stop::violation, Stop::out_of_range, Stop::sequence, Stop::fifo_overrun,
          Stop::model_missing, Stop::model_changed, Stop::bad_check, Stop::bad_address,
          Stop::memory_stalled, Stop::host_silent, Stop::bad_descriptor})
        EXPECT_GT(stops[static_cast<size_t>(stop)], 5) << name_of(stop);
}

TEST(CircuitPort, SaysWhereTheCircuitDiffers) {
    EmulatedDevice device = emulated_device(small_config()).value();
    const auto difference = std::make_shared<std::string>();
    const DevicePort port = port_with_circuit(device, {}, difference).value();
    EXPECT_EQ(port.read(Register::identification), identification_word);
    EXPECT_EQ(port.read(Register::permit_seq), 0U);
    EXPECT_EQ(*difference, "");
    device.state.permits.permit_sequence = 5;
    EXPECT_EQ(port.read(Register::permit_seq), 0U);
    EXPECT_EQ(*difference,
              "in cycle 12, register 0x034 of the circuit is 0x0, and that of the emulator 0x5");
}

TEST(CircuitPort, NeedsACircuitOfTheSameSize) {
    DeviceConfig config = small_config();
    config.fifo_depth = 9;
    EmulatedDevice device = emulated_device(config).value();
    EXPECT_FALSE(port_with_circuit(device, {}, std::make_shared<std::string>()));
}

} // namespace
} // namespace hwsim::rtl

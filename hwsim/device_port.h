#pragma once

#include <functional>

#include "hwsim/coprocessor.h"

namespace hwsim {

/// How a driver reaches a device, whatever is behind it: registers and memory, and nothing else.
struct DevicePort {
    std::function<uint32_t(Register)> read;
    std::function<void(uint32_t address, uint32_t value)> write; // address in bytes
    std::function<bool(uint32_t line, const Line&)> store;       // by DMA; false: no room yet
    std::function<void()> wait; // a little time passes, because something is not ready
};

/// A device of which every cycle is emulated. Each access to a register takes some cycles, and so
/// does each wait.
struct EmulatedDevice {
    DeviceConfig config;
    CoprocessorState state;
    uint32_t bus_cycles = 4;

    bool operator==(const EmulatedDevice&) const = default;
};

/// Errors: those of checked().
core::Result<EmulatedDevice> emulated_device(const DeviceConfig& config);

/// The functional model behind the same registers: what is pushed is answered at once.
struct FunctionalDevice {
    DeviceConfig config;
    CoprocessorState state; // without elements

    bool operator==(const FunctionalDevice&) const = default;
};

/// Errors: those of checked().
core::Result<FunctionalDevice> functional_device(const DeviceConfig& config);

/// The devices must live as long as the ports, where they are. `after_cycle` looks on.
DevicePort port_of(EmulatedDevice& device,
                   std::function<void(const CoprocessorState&)> after_cycle = {});
DevicePort port_of(FunctionalDevice& device);

} // namespace hwsim

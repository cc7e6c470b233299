#pragma once

#include <functional>
#include <memory>
#include <string>

#include "hwsim/coprocessor.h"
#include "hwsim/driver.h"

namespace hwsim {

/// How a circuit differs from the emulator; empty as long as it does not.
using CircuitDifference = std::shared_ptr<std::string>;

/// A port to the circuit in rtl/, with an emulated device beside it for what registers do not tell.
/// Both have the same memories and clock edges. The driver reads the registers of the circuit;
/// where those of the emulated device are not the same, `difference` says so.
///
/// The device must outlive the port and must not move. `after_cycle` is called after each cycle.
///
/// Errors:  those of RtlDevice::with(); this program was built without the circuit.
core::Result<DevicePort> port_with_circuit(EmulatedDevice& device,
                                           std::function<void(const CoprocessorState&)> after_cycle,
                                           const CircuitDifference& difference);

} // namespace hwsim

#include "hwsim/circuit_port.h"

namespace hwsim {

core::Result<DevicePort> port_with_circuit(EmulatedDevice&,
                                           std::function<void(const CoprocessorState&)>,
                                           const CircuitDifference&) {
    return core::fail(core::ErrorCode::unsupported,
                      "this program was built without the circuit: build it with "
                      "-D FEELER_CIRCUIT_DEVICE=ON, which needs verilator");
}

} // namespace hwsim

#pragma once

#include <functional>
#include <string>

#include "app/gate/line_check.h"
#include "core/base/result.h"

namespace app {

/// Where a gate finds the controller, and where a sender finds the gate.
struct GatePorts {
    std::string controller; // "/dev/ttyUSB0", "COM3", or "192.168.1.5:23"
    unsigned baud = 115200; // of a serial port
    std::string listen;     // "127.0.0.1:2300"; empty: no TCP
    std::string terminal;   // the path of a link to a pseudo-terminal; empty: none
};

/// How many lines a gate let pass, and how many it refused.
struct GateCounts {
    uint64_t passed = 0, refused = 0;
};

/// Runs a gate until `is_stopped`, which is polled. `note`: for whoever watches the gate itself.
///
/// Errors: a port that cannot be opened; unsupported for a pseudo-terminal where the system has
///         none; io when the controller is gone.
core::Result<GateCounts> run_gate(const GatePorts& ports, LineCheck& check,
                                  const std::function<bool()>& is_stopped,
                                  const std::function<void(const std::string&)>& note);

} // namespace app

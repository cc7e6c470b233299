#pragma once

#include "app/session/permit_timing.h"
#include "hwsim/device_config.h"

namespace app {

/// What a device takes to work, picojoules: an estimate for a present-day FPGA, to be replaced by
/// measured values.
struct EnergyTable {
    double box_test = 15.0, pair_test = 25.0, cache_line = 40.0;
    double memory_line = 12'000.0; // 512 bits from outside
    double idle_watts = 0.5;       // of the whole device
};

/// A coprocessor and the control that it works for.
struct DeviceFile {
    hwsim::DeviceConfig device;
    ControlConfig control;
    EnergyTable energy;
};

/// Reads [device], [control] and [energy] of a TOML file; what it leaves out is as usual.
///
/// Errors: with file, line and column: no file, no TOML, an unknown key, a value that cannot be.
core::Result<DeviceFile> read_device_file(const std::string& path);

} // namespace app

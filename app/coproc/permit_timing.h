#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "core/sim/run/permit_run.h"
#include "hwsim/registers.h"

namespace app {

/// The control beside the device.
struct ControlConfig {
    core::ServoTiming servo;
    uint32_t look_ahead = 256; // blocks that it reads, and asks permits for, ahead of the machine
};

/// How long a device takes for each block, and which of them it refuses. Measured while the blocks
/// follow each other as fast as the device takes them in.
struct BlockService {
    double seconds = 0.0; // from when it is asked for to its permit
    bool refused = false;
    double interval = 0.0; // behind the permit of the block before
};

/// When a block is permitted at the latest that was asked for then, the one before having been
/// permitted then.
inline double permit_time(const BlockService& service, double asked, double before) {
    return std::max(before + service.interval, asked + service.seconds);
}

/// When a block was asked for, permitted, needed and begun, seconds after the start of the program.
struct BlockTiming {
    double asked = core::infinity;
    double permitted = core::infinity; // or refused
    double due = core::infinity;       // that is when the machine had to know; infinite for a block
                                       // that does not move, and for the first that does
    double entered = core::infinity;

    double slack() const { return due - permitted; }
    bool is_late() const { return permitted > due; }
};

/// A program in time, with a device that permits its blocks.
struct PermitTiming {
    std::vector<BlockTiming> blocks;
    double planned = 0.0;           // what the machine takes if it never waits, seconds
    double taken = 0.0;             // until the end, or until it stands before what is refused
    std::optional<size_t> refused;  // the block before which it stands
    std::optional<size_t> tightest; // the block with the least slack
    size_t missed = 0;              // permits that came late
    double busy = 0.0;              // seconds that the device worked
};

/// Lets the machine run its plan against the device, which works on a block from when the control
/// has read it: it is permitted its time after that, and its interval after the block before, at
/// the latest. A device that has less to do than when it was measured answers sooner.
///
/// `past_refusals`: what is refused is run all the same, as if a person had let it.
PermitTiming timed_with_permits(const std::vector<core::PermitMotion>& plan,
                                const std::vector<BlockService>& services,
                                const ControlConfig& control, bool past_refusals = false);

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

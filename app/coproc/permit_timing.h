#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "core/sim/run/permit_run.h"
#include "hwsim/registers.h"

namespace app {

/// The control that uses the device.
struct ControlConfig {
    core::ServoTiming servo;
    uint32_t look_ahead = 256; // blocks read, and permits requested, ahead of the machine
    double line_time = 1e-6;   // that it needs to make a line for the device, s
};

/// The time that a device needs for each block, and whether it refuses it. Measured while blocks
/// follow each other as fast as the device accepts them.
struct BlockService {
    double seconds = 0.0; // from request to permit
    bool refused = false;
    double interval = 0.0; // from the permit of the previous block
    double making = 0.0;   // of the control, before the request
};

/// The latest times of permits of blocks, one after the other: the control makes the lines of a
/// block when it has read it and made those of the one before, and the device permits it when it
/// is served and its interval after the one before is over.
class PermitQueue {
public:
    /// The permit of the next block, which the control has read at `read`.
    double next(const BlockService& service, double read) {
        requested_ = std::max(requested_, read) + service.making;
        permitted_ = std::max(permitted_ + service.interval, requested_ + service.seconds);
        return permitted_;
    }
    /// When the last block was requested.
    double requested() const { return requested_; }
    /// A refusal stops the device.
    void stop() { permitted_ = core::infinity; }

private:
    double requested_ = 0.0, permitted_ = 0.0;
};

/// When a block was requested, permitted, needed and entered, in seconds from the start of the
/// program.
struct BlockTiming {
    double asked = core::infinity;     // when the control had made its lines
    double permitted = core::infinity; // or refused
    double due = core::infinity;       // when the machine needed the permit; infinite for blocks
                                       // without motion and for the first with motion
    double entered = core::infinity;

    double slack() const { return due - permitted; }
    bool is_late() const { return permitted > due; }
};

/// The timing of a program with a device that permits its blocks.
struct PermitTiming {
    std::vector<BlockTiming> blocks;
    double planned = 0.0; // duration without waiting, s
    double taken = 0.0;   // duration until the end, or until it stops at a refused block, s
    std::optional<size_t> refused;  // the block at which the machine stops
    std::optional<size_t> tightest; // the block with the least slack
    size_t missed = 0;              // number of late permits
    double busy = 0.0;              // working time of the device, s
    double making = 0.0;            // of the control, for the lines of all requested blocks, s
};

/// Simulates the machine with its plan, the control and the device. The control makes the lines of
/// a block when it has read it; the device then starts it, and permits it at the latest after its
/// service time, and its interval after the previous block. A device that is less loaded than in
/// the measurement answers earlier.
///
/// `past_refusals`: refused blocks are executed, as if a person had allowed them.
PermitTiming timed_with_permits(const std::vector<core::PermitMotion>& plan,
                                const std::vector<BlockService>& services,
                                const ControlConfig& control, bool past_refusals = false);

/// Energy per operation of a device, pJ: estimates for a current FPGA, to be replaced by measured
/// values.
struct EnergyTable {
    double box_test = 15.0, pair_test = 25.0, cache_line = 40.0;
    double memory_line = 12'000.0; // 512 bits from external memory
    double idle_watts = 0.5;       // of the whole device
};

/// A coprocessor and the control that uses it.
struct DeviceFile {
    hwsim::DeviceConfig device;
    ControlConfig control;
    EnergyTable energy;
};

/// Reads [device], [control] and [energy] of a TOML file; missing values have their defaults.
///
/// Errors: with file, line and column: a missing file, invalid TOML, an unknown key, an impossible
///         value.
core::Result<DeviceFile> read_device_file(const std::string& path);

} // namespace app

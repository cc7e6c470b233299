#pragma once

#include "app/session/check_run.h"
#include "app/session/device_pipeline.h"
#include "core/sim/permit_run.h"

namespace app {

/// How long a device took for a block, in cycles.
struct BlockCycles {
    uint64_t latency = 0;  // from its first word to its permit
    uint64_t interval = 0; // of these, those behind the permit of the block before
};

/// A program run beside a coprocessor of which every cycle is emulated.
struct CoprocessorRun {
    CheckRun check; // what the exact engine says
    std::vector<DeviceBlock> blocks;
    DeviceTotals totals;
    std::vector<core::PermitMotion> plan; // the machine's; `segment` is the block of a motion
    // Cycles of each block on devices with other numbers of elements.
    std::map<uint32_t, std::vector<BlockCycles>> cycles_by_elements;
};

/// What is asked of a run.
struct CoprocessorJob {
    CheckJob check;
    hwsim::DeviceConfig device;
    std::vector<uint32_t> other_elements = {}; // to be emulated as well
    // Sees the device after each cycle; empty: nobody does.
    std::function<void(const BlocksInDevice&, const hwsim::CoprocessorState&)> on_cycle = {};
};

/// Runs a program: each block is asked of the device before the machine simulation carries it out,
/// with the stock as it will be then, and the device goes on with it while the next ones come.
/// Where `check.after_block` says so it ends early.
///
/// Errors: those of run_check and of the driver. An error inside the program ends the run.
/// Cost:   that of the check, and for each device about 0.4 us a cycle.
core::Result<CoprocessorRun> run_beside_coprocessor(const CoprocessorJob& job);

} // namespace app

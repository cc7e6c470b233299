#pragma once

#include "app/session/check_run.h"
#include "app/session/coprocessor_check.h"
#include "core/sim/permit_run.h"

namespace app {

/// Sums over a whole run, in the device's own counters.
struct DeviceTotals {
    std::array<uint64_t, hwsim::counter_count> counters{};

    uint64_t operator[](hwsim::Counter counter) const {
        return counters[static_cast<size_t>(counter)];
    }
};

/// What the coprocessor did for a block.
struct DeviceBlock {
    BlockPermit permit;
    uint64_t cycles = 0; // from the first word of the stock or the block to its permit
    uint64_t nodes = 0;  // visited in both trees
    uint64_t pairs = 0;  // of records compared
    DeviceTotals after;  // from reset to the end of the block
};

/// A program run beside a coprocessor of which every cycle is emulated.
struct CoprocessorRun {
    CheckRun check; // what the exact engine says
    std::vector<DeviceBlock> blocks;
    DeviceTotals totals;
    std::vector<core::PermitMotion> plan; // the machine's; `segment` is the block of a motion
    // Cycles of each block on devices with other numbers of elements.
    std::map<uint32_t, std::vector<uint64_t>> cycles_by_elements;
};

/// What is asked of a run.
struct CoprocessorJob {
    CheckJob check;
    hwsim::DeviceConfig device;
    std::vector<uint32_t> other_elements = {}; // to be emulated as well
    // Sees the device after each cycle of a block; empty: nobody does.
    std::function<void(size_t block, const hwsim::CoprocessorState&)> on_cycle = {};
};

/// Runs a program: each block is asked of the device before the machine simulation carries it out,
/// with the stock as it will be then. Where `check.after_block` says so it ends early.
///
/// Errors: those of run_check and of the driver. An error inside the program ends the run.
/// Cost:   that of the check, and for each device about 0.4 us a cycle.
core::Result<CoprocessorRun> run_beside_coprocessor(const CoprocessorJob& job);

} // namespace app

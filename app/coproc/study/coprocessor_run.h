#pragma once

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/coproc/device_answer.h"
#include "app/coproc/permit_timing.h"
#include "core/sim/run/permit_run.h"

namespace hwsim {
struct CoprocessorState;
}

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

/// A device that would have been fast enough.
struct DeviceFit {
    uint32_t elements = 0;
    std::optional<uint32_t> clock_mhz; // the least of `clocks`; empty: none of them
};

/// What clocks are tried, MHz.
constexpr std::array<uint32_t, 12> clocks = {1, 2, 5, 10, 20, 25, 50, 75, 100, 150, 200, 300};

/// What numbers of elements are.
constexpr std::array<uint32_t, 5> tried_elements = {1, 2, 4, 8, 16};

/// How long a device at this clock takes for each block.
std::vector<BlockService> services_of(const CoprocessorRun& run, uint32_t clock_mhz);

/// For each number of elements that was emulated the least clock with which no permit would have
/// been late.
std::vector<DeviceFit> least_clocks(const CoprocessorRun& run, const ControlConfig& control);

/// The one of them that needs the fewest elements times clock.
std::optional<DeviceFit> smallest(const std::vector<DeviceFit>& fits);

} // namespace app

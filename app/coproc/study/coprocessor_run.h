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

/// The time of a device for a block, in cycles.
struct BlockCycles {
    uint64_t latency = 0;  // from its first word to its permit
    uint64_t interval = 0; // of these, those after the permit of the previous block
    uint64_t lines = 0;    // that the host made before
};

/// The run of a program with a coprocessor emulated cycle by cycle.
struct CoprocessorRun {
    CheckRun check; // the check with the exact engine
    std::vector<DeviceBlock> blocks;
    DeviceTotals totals;
    std::vector<core::PermitMotion> plan; // of the machine; `segment` is the block of a motion
    // Cycles of each block on devices with other numbers of elements.
    std::map<uint32_t, std::vector<BlockCycles>> cycles_by_elements;
};

/// The input of a run.
struct CoprocessorJob {
    CheckJob check;
    hwsim::DeviceConfig device;
    bool on_circuit = false;                   // the circuit answers, beside the emulated device
    std::vector<uint32_t> other_elements = {}; // further devices to emulate
    // Called with the device after each cycle; may be empty.
    std::function<void(const BlocksInDevice&, const hwsim::CoprocessorState&)> on_cycle = {};
};

/// Runs a program. Before the machine simulation executes a block, it is pushed to the device with
/// the stock of that moment; the device processes it while further blocks follow.
/// `check.after_block` may end the run early.
///
/// Errors: those of run_check and of the driver. An error inside the program ends the run.
/// Cost:   that of the check, and for each device about 0.4 us a cycle.
core::Result<CoprocessorRun> run_with_coprocessor(const CoprocessorJob& job);

/// A device that is fast enough.
struct DeviceFit {
    uint32_t elements = 0;
    std::optional<uint32_t> clock_mhz; // the lowest of `clocks`; empty: none suffices
};

/// The clocks that are tried, MHz.
constexpr std::array<uint32_t, 12> clocks = {1, 2, 5, 10, 20, 25, 50, 75, 100, 150, 200, 300};

/// The numbers of elements that are tried.
constexpr std::array<uint32_t, 5> tried_elements = {1, 2, 4, 8, 16};

/// The service time of each block with a device at this clock.
std::vector<BlockService> services_of(const CoprocessorRun& run, uint32_t clock_mhz,
                                      const ControlConfig& control);

/// For each emulated number of elements, the lowest clock at which no permit would be late.
std::vector<DeviceFit> least_clocks(const CoprocessorRun& run, const ControlConfig& control);

/// The fit with the smallest product of elements and clock.
std::optional<DeviceFit> smallest(const std::vector<DeviceFit>& fits);

} // namespace app

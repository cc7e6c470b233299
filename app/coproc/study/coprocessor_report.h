#pragma once

#include <string>

#include "app/coproc/permit_timing.h"
#include "app/coproc/study/coprocessor_run.h"

namespace app {

struct EngineAgreement;

/// A program run with a coprocessor, and all results.
struct CoprocessorResult {
    CoprocessorRun run;
    DeviceFile file;
    PermitTiming timing;
    std::vector<DeviceFit> fits; // for the other devices that were emulated
};

/// Adds timing to a run: when the device answered and when the machine needed the answer.
/// `past_refusals`: as if a person had allowed every refused block.
CoprocessorResult in_time(CoprocessorRun run, const DeviceFile& file, bool past_refusals);

/// Utilisation of a device between two readings of its counters.
struct DeviceUse {
    double busy = 0.0;                             // fraction of the cycles of all elements
    double memory = 0.0, ports = 0.0, order = 0.0; // waiting, fraction of busy threads' cycles
    std::optional<double> node_hits, record_hits;  // fractions of cache reads; empty: no reads
};

/// The utilisation between one reading of the counters and a later one.
DeviceUse use_between(const DeviceTotals& before, const DeviceTotals& after,
                      const hwsim::DeviceConfig& device);

/// The agreement over a whole run.
EngineAgreement agreement(const CoprocessorRun& run);

/// Figures of the device over a whole run.
struct DeviceFigures {
    double busy_fraction = 0.0;                 // fraction of the machine's time
    double queries_per_second = 0.0;            // while busy
    double p50 = 0.0, p99 = 0.0, longest = 0.0; // seconds from a block's first word to its permit
    double memory_stall = 0.0, port_stall = 0.0, order_stall = 0.0; // fractions of threads' cycles
    double node_hits = 0.0, record_hits = 0.0;                      // fractions
    double bytes_per_second = 0.0;                                  // from memory, while busy
    double joules = 0.0;                                            // estimate
    uint64_t lines_made = 0;    // by the control, for the device
    double control_share = 0.0; // of the time, for which it makes them
};

DeviceFigures figures(const CoprocessorResult& result);

/// Why a block is not permitted: the pair of bodies, the reason why the device stopped, or the
/// reason why it could not be asked.
std::string refusal(const CoprocessorResult& result, size_t block);

/// A time with a suitable unit: 31.5 us, 2.1 ms, 3.40 s, 12 min 05 s.
std::string time_text(double seconds);

/// The smallest sufficient device, as text.
std::string fit_text(const std::vector<DeviceFit>& fits);

std::string coprocessor_text(const CoprocessorResult& result);
std::string coprocessor_json(const CoprocessorResult& result);
/// A row for each block (RFC 4180).
std::string coprocessor_csv(const CoprocessorResult& result);

} // namespace app

#pragma once

#include <string>

#include "app/coproc/permit_timing.h"
#include "app/coproc/study/coprocessor_run.h"

namespace app {

/// A program beside a coprocessor, with everything that is told of it.
struct CoprocessorResult {
    CoprocessorRun run;
    DeviceFile file;
    PermitTiming timing;
    std::vector<DeviceFit> fits; // of the devices that were emulated as well
};

/// Puts a run into time: when the device's word was there, and when the machine needed it.
/// `past_refusals`: as if a person had let every refused block.
CoprocessorResult in_time(CoprocessorRun run, const DeviceFile& file, bool past_refusals);

/// What the threads of a device did over a stretch of its counters.
struct DeviceShares {
    double busy = 0.0;                             // of the cycles of all elements
    double memory = 0.0, ports = 0.0, order = 0.0; // of busy threads' cycles: waiting
    std::optional<double> node_hits, record_hits;  // of what caches were asked; empty: nothing
};

/// From one reading of the counters to a later one.
DeviceShares shares_between(const DeviceTotals& before, const DeviceTotals& after,
                            const hwsim::DeviceConfig& device);

/// How the answers of a coprocessor stand to those of the exact engine, in blocks.
struct EngineAgreement {
    size_t blocks = 0;
    size_t violations = 0;   // violations and collisions by the exact engine
    size_t refused = 0;      // by the device
    size_t not_asked = 0;    // of these, motions that the device cannot be asked
    size_t missed = 0;       // violations that the device permitted
    size_t undecided = 0;    // refused, and undecided by the exact engine
    size_t false_alarms = 0; // refused, and clear by the exact engine

    bool operator==(const EngineAgreement&) const = default;
};

/// Counts a block.
void add(EngineAgreement& agreement, const BlockPermit& permit, const core::BlockResult& exact);

/// How the two engines stand to each other.
EngineAgreement agreement(const CoprocessorRun& run);

/// Figures of the device over the whole run.
struct DeviceFigures {
    double busy_share = 0.0;                    // of the machine's time
    double queries_per_second = 0.0;            // while it works
    double p50 = 0.0, p99 = 0.0, longest = 0.0; // seconds from a block's first word to its permit
    double memory_stall = 0.0, port_stall = 0.0, order_stall = 0.0; // shares of threads' cycles
    double node_hits = 0.0, record_hits = 0.0;                      // shares
    double bytes_per_second = 0.0;                                  // from memory, while it works
    double joules = 0.0;                                            // estimate
};

DeviceFigures figures(const CoprocessorResult& result);

/// Why a block is not permitted: the pair of bodies, why the device stopped, or why it could not be
/// asked.
std::string refusal(const CoprocessorResult& result, size_t block);

/// A time as a person reads it: 31.5 us, 2.1 ms, 3.40 s, 12 min 05 s.
std::string time_text(double seconds);

/// How small a device would have done.
std::string fit_text(const std::vector<DeviceFit>& fits);

std::string coprocessor_text(const CoprocessorResult& result);
std::string coprocessor_json(const CoprocessorResult& result);
/// A row to each block (RFC 4180).
std::string coprocessor_csv(const CoprocessorResult& result);

} // namespace app

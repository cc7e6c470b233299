#pragma once

#include <string>

#include "app/session/coprocessor_result.h"
#include "app/session/engine_agreement.h"

namespace app {

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

#pragma once

#include <string>

#include "app/session/device_fit.h"
#include "app/session/engine_agreement.h"
#include "app/setup/device_file.h"

namespace app {

/// A program beside a coprocessor, with everything that reports tell of it.
struct CoprocessorResult {
    CoprocessorRun run;
    DeviceFile file;
    PermitTiming timing;
    std::vector<DeviceFit> fits;
};

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

std::string coprocessor_text(const CoprocessorResult& result);
std::string coprocessor_json(const CoprocessorResult& result);
/// A row to each block (RFC 4180).
std::string coprocessor_csv(const CoprocessorResult& result);

} // namespace app

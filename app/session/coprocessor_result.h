#pragma once

#include "app/session/device_fit.h"
#include "app/setup/device_file.h"

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

} // namespace app

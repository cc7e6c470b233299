#pragma once

#include "app/report/coprocessor_report.h"
#include "app/viewer/minimum_tree.h"

namespace app::viewer {

/// What the device has said of a block.
enum class DeviceAnswer : uint8_t {
    unknown,   // no run, or none that came so far
    nothing,   // nothing moves that it could be asked about
    permitted, // in time
    late,      // permitted when the machine needed it already
    refused,
    not_asked // the device cannot be asked, so it is not permitted
};

/// A program that was run beside the device, and what the window needs of that at any time. Does
/// not change.
struct DeviceStudy {
    CoprocessorResult result; // with every refused block let, so that all have their times
    DeviceFigures figures;
    EngineAgreement agreement;
    MinimumTree slack;          // cells: seconds between permit and need
    std::vector<size_t> stops;  // blocks that are late or not permitted, in order
    std::optional<size_t> held; // the first that is not permitted: the machine stands before it
    double near = 0.0;          // slack below which there is little of it, seconds

    size_t size() const { return result.run.blocks.size(); }
};

/// Makes ready what the window shows.
std::shared_ptr<const DeviceStudy> study_of(CoprocessorResult result);

/// Of a block; unknown without a study.
DeviceAnswer answer_of(const DeviceStudy* study, size_t block);

/// Whether the machine has to wait before it, or may not run it at all.
bool stops_machine(DeviceAnswer answer);

/// Seconds from the permit of a block until it was due; empty where nothing was.
std::optional<double> slack_of(const DeviceStudy* study, size_t block);

} // namespace app::viewer

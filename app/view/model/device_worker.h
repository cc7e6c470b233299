#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/view/model/timeline.h"
#include "core/base/result.h"

namespace app {
struct CheckJob;
struct CoprocessorResult;
struct DeviceFigures;
struct EngineAgreement;
} // namespace app

namespace app::viewer {

/// The answer of the device for a block.
enum class DeviceAnswer : uint8_t {
    unknown,   // no run, or it has not reached the block
    nothing,   // the block moves nothing
    permitted, // in time
    late,      // permitted, but later than the machine needed it
    refused,
    not_queried // the device cannot check it, so it is not permitted
};

/// The results of a program run with the coprocessor, as the window shows them. Never changes.
struct DeviceStudy {
    std::shared_ptr<const CoprocessorResult> result; // has times for every block, also refused
    std::shared_ptr<const DeviceFigures> figures;
    std::shared_ptr<const EngineAgreement> agreement;
    MinimumTree slack;          // cells: seconds between permit and need
    std::vector<size_t> stops;  // blocks that are late or not permitted, in program order
    std::optional<size_t> held; // the first that is not permitted: the machine stops before it
    double near = 0.0;          // a slack below this is shown as small, seconds

    size_t size() const { return slack.size(); }
};

/// Prepares the result of a run for the window.
std::shared_ptr<const DeviceStudy> study_of(CoprocessorResult result);

/// The answer for a block; unknown without a study.
DeviceAnswer answer_of(const DeviceStudy* study, size_t block);

/// Whether the machine has to wait before the block, or may not run it.
bool stops_machine(DeviceAnswer answer);

/// Seconds from the permit of a block until the machine needed it; empty if it needed none.
std::optional<double> slack_of(const DeviceStudy* study, size_t block);

/// What a run has produced since the last update.
struct DeviceUpdate {
    uint64_t run = 0; // number of the run
    double fraction = 0.0;
    size_t blocks = 0;                        // answered so far
    bool is_fitting = false;                  // true while other devices are tried
    bool is_done = false;                     // this is the last update
    std::shared_ptr<const DeviceStudy> study; // replaces an earlier one
    std::optional<core::Error> failure;
    bool has_news = false;
};

/// Runs a program, always the last one requested, with the emulated coprocessor in a separate
/// thread. Requests return at once. A run delivers two studies: one when the device has answered
/// for all blocks, one when other devices have been tried.
class DeviceWorker {
public:
    /// `wake` is called from the thread whenever there is an update.
    explicit DeviceWorker(std::function<void()> wake);
    /// Aborts the current run.
    ~DeviceWorker();

    /// Aborts the current run and starts another one. `device_file`: path of the device file;
    /// empty: the default device. Returns the number of the run, above 0.
    uint64_t start(const CheckJob& check, const std::string& device_file);
    /// Aborts the current run.
    void stop();
    /// Everything new since the last call.
    DeviceUpdate take();

private:
    class Thread;
    std::unique_ptr<Thread> thread_;
};

} // namespace app::viewer

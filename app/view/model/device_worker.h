#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "app/check/check_run.h"
#include "app/coproc/study/coprocessor_report.h"
#include "app/view/model/timeline.h"

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

/// What is to be run beside a device.
struct DeviceJob {
    CheckJob check;
    std::string file; // of the device; empty: the usual one
};

/// Everything that has become known of a run since the last look.
struct DeviceUpdate {
    uint64_t run = 0; // its number
    double share = 0.0;
    size_t blocks = 0;                        // that were asked
    bool is_fitting = false;                  // smaller and larger devices are tried
    bool is_done = false;                     // nothing more will come
    std::shared_ptr<const DeviceStudy> study; // a later one replaces the one before
    std::optional<core::Error> failure;
    bool has_news = false;
};

/// A thread of its own that runs programs beside the emulated coprocessor, the last one that was
/// asked for. Requests return at once. A run is told twice: as soon as the device has answered to
/// all blocks, and again when other devices have been tried.
class DeviceWorker {
public:
    /// `wake` is called from the thread whenever there is news.
    explicit DeviceWorker(std::function<void()> wake);
    /// Ends the run, wherever it is.
    ~DeviceWorker();
    DeviceWorker(const DeviceWorker&) = delete;
    DeviceWorker& operator=(const DeviceWorker&) = delete;

    /// Ends what is run, and begins anew. The number of the run, above 0.
    uint64_t start(const DeviceJob& job);
    /// Ends what is run.
    void stop();
    /// What is new since the last call.
    DeviceUpdate take();

private:
    void work();
    void carry_out(const DeviceJob& job, uint64_t run);
    core::Result<CoprocessorResult> emulate(const DeviceJob& job, const DeviceFile& file,
                                            std::vector<uint32_t> others, uint64_t run);
    bool is_over(uint64_t run) const { return stopping_ || runs_ != run; }
    void deliver(DeviceUpdate news);

    std::function<void()> wake_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<DeviceJob> wanted_;
    DeviceUpdate news_;
    std::atomic<bool> stopping_ = false;
    std::atomic<uint64_t> runs_ = 0; // that were begun or ended
    std::thread thread_;             // last: it uses all of the above
};

} // namespace app::viewer

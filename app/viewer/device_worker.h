#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "app/session/check_run.h"
#include "app/viewer/device_study.h"

namespace app::viewer {

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

#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace app::viewer {

/// A thread that always does the last job requested, and what it has produced since the last look.
///
/// `Update` has the number `run` of the job and the flag `has_news`.
template <typename Job, typename Update>
class JobThread {
public:
    /// Does a job; ends early once `is_over(run)`.
    using Work = std::function<void(const Job& job, uint64_t run)>;

    /// `wake` is called from the thread whenever there is an update.
    JobThread(std::function<void()> wake, Work work)
        : wake_(std::move(wake)), work_(std::move(work)), thread_([this] { loop(); }) {}

    /// Aborts the current job and waits for its end.
    ~JobThread() {
        {
            const std::lock_guard lock(mutex_);
            stopping_ = true;
        }
        changed_.notify_all();
        thread_.join();
    }

    /// Aborts the current job and starts another one. Returns its number, above 0.
    uint64_t start(Job job) {
        uint64_t run = 0;
        {
            const std::lock_guard lock(mutex_);
            wanted_ = std::move(job);
            news_ = {};
            run = ++runs_;
        }
        changed_.notify_all();
        return run;
    }

    /// Aborts the current job.
    void stop() {
        const std::lock_guard lock(mutex_);
        wanted_.reset();
        news_ = {};
        ++runs_;
    }

    /// Everything new since the last call.
    Update take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(news_, {});
    }

    // For the work:

    /// Whether the job with this number was aborted.
    bool is_over(uint64_t run) const { return stopping_ || runs_ != run; }

    /// Replaces the update that was not taken yet. `keep(news, untaken)` moves what must not be
    /// lost.
    template <typename Keep>
    void deliver(Update news, const Keep& keep) {
        {
            const std::lock_guard lock(mutex_);
            if (is_over(news.run)) return;
            keep(news, news_);
            news_ = std::move(news);
            news_.has_news = true;
        }
        wake_();
    }
    void deliver(Update news) {
        deliver(std::move(news), [](Update&, Update&) {});
    }

private:
    void loop() {
        while (true) {
            Job job;
            uint64_t run = 0;
            {
                std::unique_lock lock(mutex_);
                changed_.wait(lock, [&] { return stopping_ || wanted_; });
                if (stopping_) return;
                job = *std::exchange(wanted_, std::nullopt);
                run = runs_;
            }
            work_(job, run);
        }
    }

    std::function<void()> wake_;
    Work work_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Job> wanted_;
    Update news_;
    std::atomic<bool> stopping_ = false;
    std::atomic<uint64_t> runs_ = 0; // counts starts and stops; the current job has this number
    std::thread thread_;             // last: it uses all of the above
};

} // namespace app::viewer

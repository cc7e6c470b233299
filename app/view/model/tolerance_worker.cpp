#include "app/view/model/tolerance_worker.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/tolerance/tolerances.h"

namespace app::viewer {

class ToleranceWorker::Thread {
public:
    explicit Thread(std::function<void()> wake);
    ~Thread();

    uint64_t start(const CheckJob& job);
    void stop();
    ToleranceUpdate take();

private:
    void work();
    void run_job(CheckJob job, uint64_t run);
    bool is_over(uint64_t run) const { return stopping_ || runs_ != run; }
    void deliver(ToleranceUpdate news);

    std::function<void()> wake_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<CheckJob> wanted_;
    ToleranceUpdate news_;
    std::atomic<bool> stopping_ = false;
    std::atomic<uint64_t> runs_ = 0; // counts starts and stops; the current run has this number
    std::thread thread_;             // last: it uses all of the above
};

ToleranceWorker::Thread::Thread(std::function<void()> wake)
    : wake_(std::move(wake)), thread_([this] { work(); }) {}

ToleranceWorker::Thread::~Thread() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

uint64_t ToleranceWorker::Thread::start(const CheckJob& job) {
    uint64_t run = 0;
    {
        const std::lock_guard lock(mutex_);
        wanted_ = job;
        news_ = {};
        run = ++runs_;
    }
    changed_.notify_all();
    return run;
}

void ToleranceWorker::Thread::stop() {
    const std::lock_guard lock(mutex_);
    wanted_.reset();
    news_ = {};
    ++runs_;
}

ToleranceUpdate ToleranceWorker::Thread::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(news_, {});
}

void ToleranceWorker::Thread::deliver(ToleranceUpdate news) {
    {
        const std::lock_guard lock(mutex_);
        if (is_over(news.run)) return;
        news_ = std::move(news);
        news_.has_news = true;
    }
    wake_();
}

void ToleranceWorker::Thread::work() {
    while (true) {
        CheckJob job;
        uint64_t run = 0;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return stopping_ || wanted_; });
            if (stopping_) return;
            job = *std::exchange(wanted_, std::nullopt);
            run = runs_;
        }
        run_job(std::move(job), run);
    }
}

void ToleranceWorker::Thread::run_job(CheckJob job, uint64_t run) {
    job.detail = core::Detail::verdict;
    job.after_block = [&](const CheckProgress&) { return !is_over(run); };
    const auto checked = run_check(job);
    if (is_over(run)) return;
    if (!checked) return deliver({.run = run, .found = {}, .failure = checked.error()});
    std::atomic<double> reported = 0.0;
    const auto goes_on = [&](double fraction) {
        if (fraction > reported.exchange(fraction)) deliver({.run = run, .fraction = fraction});
        return !is_over(run);
    };
    auto found = tolerances_of(job, *checked, goes_on);
    if (!found) return deliver({.run = run, .found = {}, .failure = found.error()});
    deliver({.run = run,
             .fraction = 1.0,
             .found = std::make_shared<const Tolerances>(*std::move(found))});
}

ToleranceWorker::ToleranceWorker(std::function<void()> wake)
    : thread_(std::make_unique<Thread>(std::move(wake))) {}

ToleranceWorker::~ToleranceWorker() = default;

uint64_t ToleranceWorker::start(const CheckJob& check) { return thread_->start(check); }

void ToleranceWorker::stop() { thread_->stop(); }

ToleranceUpdate ToleranceWorker::take() { return thread_->take(); }

} // namespace app::viewer

#include "app/view/model/tolerance_worker.h"

#include <atomic>
#include <utility>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/tolerance/tolerances.h"
#include "app/view/model/job_thread.h"

namespace app::viewer {

class ToleranceWorker::Thread {
public:
    explicit Thread(std::function<void()> wake)
        : jobs_(std::move(wake), [this](const CheckJob& job, uint64_t run) { run_job(job, run); }) {
    }

    uint64_t start(const CheckJob& job) { return jobs_.start(job); }
    void stop() { jobs_.stop(); }
    ToleranceUpdate take() { return jobs_.take(); }

private:
    void run_job(CheckJob job, uint64_t run);

    JobThread<CheckJob, ToleranceUpdate> jobs_;
};

void ToleranceWorker::Thread::run_job(CheckJob job, uint64_t run) {
    job.detail = core::Detail::verdict;
    job.after_block = [&](const CheckProgress&) { return !jobs_.is_over(run); };
    const auto checked = run_check(job);
    if (jobs_.is_over(run)) return;
    if (!checked) return jobs_.deliver({.run = run, .found = {}, .failure = checked.error()});
    std::atomic<double> reported = 0.0;
    const auto goes_on = [&](double fraction) {
        if (fraction > reported.exchange(fraction))
            jobs_.deliver({.run = run, .fraction = fraction});
        return !jobs_.is_over(run);
    };
    auto found = tolerances_of(job, *checked, goes_on);
    if (!found) return jobs_.deliver({.run = run, .found = {}, .failure = found.error()});
    jobs_.deliver({.run = run,
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

#include "app/view/model/device_worker.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/coproc/device_judge.h"
#include "app/coproc/study/coprocessor_report.h"
#include "app/view/model/job_thread.h"

namespace app::viewer {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto progress_interval = std::chrono::milliseconds(100);

} // namespace

/// A program to run, and the device.
struct DeviceJob {
    CheckJob check;
    std::string file; // path of the device file; empty: the default device
};

class DeviceWorker::Thread {
public:
    explicit Thread(std::function<void()> wake)
        : jobs_(std::move(wake),
                [this](const DeviceJob& job, uint64_t run) { run_job(job, run); }) {}

    uint64_t start(DeviceJob job) { return jobs_.start(std::move(job)); }
    void stop() { jobs_.stop(); }
    DeviceUpdate take() { return jobs_.take(); }

private:
    void run_job(const DeviceJob& job, uint64_t run);
    core::Result<CoprocessorResult> emulate(const DeviceJob& job, const DeviceFile& file,
                                            std::vector<uint32_t> others, uint64_t run);
    bool is_over(uint64_t run) const { return jobs_.is_over(run); }
    /// Keeps a study that the window has not taken yet.
    void deliver(DeviceUpdate news) {
        jobs_.deliver(std::move(news), [](DeviceUpdate& now, DeviceUpdate& untaken) {
            if (!now.study) now.study = std::move(untaken.study);
        });
    }

    JobThread<DeviceJob, DeviceUpdate> jobs_;
};

core::Result<CoprocessorResult> DeviceWorker::Thread::emulate(const DeviceJob& job,
                                                              const DeviceFile& file,
                                                              std::vector<uint32_t> others,
                                                              uint64_t run) {
    CoprocessorJob asked;
    asked.check = job.check;
    asked.check.detail = core::Detail::every_pair;
    asked.device = file.device;
    asked.other_elements = std::move(others);
    const bool is_fitting = !asked.other_elements.empty();
    Clock::time_point last_report = {};
    asked.check.after_block = [&](const CheckProgress& progress) {
        if (Clock::now() - last_report > progress_interval) {
            last_report = Clock::now();
            deliver({.run = run,
                     .fraction = progress.fraction,
                     .blocks = progress.blocks,
                     .is_fitting = is_fitting});
        }
        return !is_over(run);
    };
    FEELER_TRY(CoprocessorRun made, run_with_coprocessor(asked));
    if (is_over(run)) return CoprocessorResult{};
    return in_time(std::move(made), file, true);
}

void DeviceWorker::Thread::run_job(const DeviceJob& job, uint64_t run) {
    const auto fail = [&](const core::Error& error) {
        deliver({.run = run, .is_done = true, .failure = error});
    };
    DeviceFile file;
    if (!job.file.empty()) {
        const auto read = read_device_file(job.file);
        if (!read) return fail(read.error());
        file = *read;
    }
    const std::vector<uint32_t> tried(tried_elements.begin(), tried_elements.end());
    for (const std::vector<uint32_t>& others : {std::vector<uint32_t>(), tried}) {
        auto result = emulate(job, file, others, run);
        if (is_over(run)) return;
        if (!result) return fail(result.error());
        deliver({.run = run,
                 .fraction = others.empty() ? 0.0 : 1.0,
                 .is_fitting = true,
                 .is_done = !others.empty(),
                 .study = study_of(*std::move(result))});
    }
}

DeviceWorker::DeviceWorker(std::function<void()> wake)
    : thread_(std::make_unique<Thread>(std::move(wake))) {}

DeviceWorker::~DeviceWorker() = default;

uint64_t DeviceWorker::start(const CheckJob& check, const std::string& device_file) {
    return thread_->start({check, device_file});
}

void DeviceWorker::stop() { thread_->stop(); }

DeviceUpdate DeviceWorker::take() { return thread_->take(); }

namespace {

/// A slack below this number of servo periods is shown as small.
constexpr double near_periods = 10.0;

TimelineCell slack_cell(const DeviceStudy& study, size_t block) {
    const DeviceAnswer answer = answer_of(&study, block);
    const auto slack = slack_of(&study, block);
    TimelineCell cell;
    cell.known = answer != DeviceAnswer::unknown;
    cell.offending = stops_machine(answer);
    cell.moves = slack.has_value() || cell.offending;
    if (slack) cell.least = *slack;
    cell.near = slack && *slack < study.near;
    return cell;
}

} // namespace

std::shared_ptr<const DeviceStudy> study_of(CoprocessorResult result) {
    auto study = std::make_shared<DeviceStudy>();
    study->figures = std::make_shared<const DeviceFigures>(figures(result));
    study->agreement = std::make_shared<const EngineAgreement>(agreement(result.run));
    study->near = near_periods * result.file.control.servo.period;
    result.run.check.stock.reset(); // not used any more
    study->slack.resize(result.run.blocks.size());
    study->result = std::make_shared<const CoprocessorResult>(std::move(result));
    for (size_t i = 0; i < study->size(); ++i) {
        const TimelineCell cell = slack_cell(*study, i);
        study->slack.set(i, cell);
        if (cell.offending) study->stops.push_back(i);
        if (!study->held && !study->result->run.blocks[i].permit.permitted) study->held = i;
    }
    return study;
}

DeviceAnswer answer_of(const DeviceStudy* study, size_t block) {
    if (!study || block >= study->size()) return DeviceAnswer::unknown;
    const BlockPermit& permit = study->result->run.blocks[block].permit;
    if (!permit.is_checked()) return DeviceAnswer::not_queried;
    if (!permit.permitted) return DeviceAnswer::refused;
    if (study->result->timing.blocks[block].is_late()) return DeviceAnswer::late;
    return permit.segments == 0 ? DeviceAnswer::nothing : DeviceAnswer::permitted;
}

bool stops_machine(DeviceAnswer answer) {
    return answer == DeviceAnswer::late || answer == DeviceAnswer::refused
           || answer == DeviceAnswer::not_queried;
}

std::optional<double> slack_of(const DeviceStudy* study, size_t block) {
    if (!study || block >= study->size()) return {};
    const double slack = study->result->timing.blocks[block].slack();
    if (!std::isfinite(slack)) return {};
    return slack;
}

} // namespace app::viewer

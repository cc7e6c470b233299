#include "app/session/coprocessor_run.h"

#include "app/session/conclusion.h"
#include "app/session/program_runner.h"
#include "app/session/stopwatch.h"

namespace app {
namespace {

class BesideCoprocessor {
public:
    BesideCoprocessor(const CoprocessorJob& job, PreparedCheck& check)
        : job_(job), check_(check), runner_(check), ahead_(check) {
        runner_.after_block = job.check.after_block;
        runner_.on_timed = [this](const core::BlockTime& time) { plan(time); };
    }

    core::Result<CoprocessorRun> run();

private:
    core::Result<void> open();
    /// Asks all devices for the next block.
    core::Result<void> ask();
    /// Waits for their answers, and keeps them.
    core::Result<void> finish();
    void plan(const core::BlockTime& time) {
        for (const core::BlockStretch& stretch : time.stretches)
            if (stretch.time.duration > 0.0)
                made_.plan.push_back({stretch.time, core::value_of(time.block)});
    }

    const CoprocessorJob& job_;
    PreparedCheck& check_;
    ProgramRunner runner_;
    BlockRunner ahead_;
    std::unique_ptr<DevicePipeline> device_;
    std::map<uint32_t, std::unique_ptr<DevicePipeline>> others_;
    CoprocessorRun made_;
};

core::Result<void> BesideCoprocessor::open() {
    const core::CutModel& stock = runner_.place().machine.stock;
    FEELER_TRY(device_, DevicePipeline::with(job_.device, check_.run.setup, stock, job_.on_cycle));
    for (const uint32_t elements : job_.other_elements) {
        hwsim::DeviceConfig config = job_.device;
        config.elements = elements;
        FEELER_TRY(others_[elements], DevicePipeline::with(config, check_.run.setup, stock));
    }
    if (job_.check.start_line.empty()) return {};
    return runner_.start_at(job_.check.start_line);
}

core::Result<void> BesideCoprocessor::ask() {
    const RunPlace& place = runner_.place();
    const auto events = first_events(
        [&](const BlockVisit& look) { ahead_.visit_ahead(place.control, place.lowering, look); });
    if (!events) return {};
    if (auto pushed = device_->push(*events, place.machine); !pushed) return pushed;
    for (auto& [elements, device] : others_)
        if (auto pushed = device->push(*events, place.machine); !pushed) return pushed;
    return {};
}

core::Result<void> BesideCoprocessor::finish() {
    if (auto finished = device_->finish(); !finished) return finished;
    made_.blocks = device_->blocks();
    made_.blocks.resize(check_.run.blocks.size());
    made_.totals = device_->totals();
    for (auto& [elements, device] : others_) {
        if (auto finished = device->finish(); !finished) return finished;
        std::vector<BlockCycles>& cycles = made_.cycles_by_elements[elements];
        for (const DeviceBlock& block : device->blocks())
            cycles.push_back({block.cycles, block.interval});
        cycles.resize(made_.blocks.size());
    }
    return {};
}

core::Result<CoprocessorRun> BesideCoprocessor::run() {
    const Stopwatch checking;
    if (auto opened = open(); !opened) return tl::unexpected(std::move(opened).error());
    do
        if (auto done = ask(); !done) return tl::unexpected(std::move(done).error());
    while (runner_.advance() && (!runner_.after_block || runner_.after_block(runner_.progress())));
    if (auto finished = finish(); !finished) return tl::unexpected(std::move(finished).error());
    check_.run.times.check = checking.seconds();
    conclude(check_, runner_.place().machine, runner_.length_doubts(), false);
    made_.check = std::move(check_.run);
    return std::move(made_);
}

} // namespace

core::Result<CoprocessorRun> run_beside_coprocessor(const CoprocessorJob& job) {
    FEELER_TRY(PreparedCheck check, prepare_check(job.check));
    return BesideCoprocessor(job, check).run();
}

} // namespace app

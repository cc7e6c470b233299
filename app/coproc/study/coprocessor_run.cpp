#include "app/coproc/study/coprocessor_run.h"

#include <algorithm>

#include "app/base/stopwatch.h"
#include "app/check/prepared_check.h"
#include "app/check/program_runner.h"
#include "app/coproc/device_judge.h"
#include "core/sim/run/block_clock.h"
#include "core/sim/run/simulator.h"

namespace app {
namespace {

class ParallelCoprocessor {
public:
    ParallelCoprocessor(const CoprocessorJob& job, PreparedCheck& check)
        : job_(job), check_(check), runner_(check) {
        runner_.after_block = job.check.after_block;
        runner_.on_timed = [this](const core::BlockTime& time) { plan(time); };
    }

    core::Result<CoprocessorRun> run();

private:
    core::Result<void> open();
    /// Pushes the next block to all devices.
    core::Result<void> ask();
    /// Waits for their answers and stores them.
    core::Result<void> finish();
    void plan(const core::BlockTime& time) {
        for (const core::BlockStretch& stretch : time.stretches)
            if (stretch.time.duration > 0.0)
                made_.plan.push_back({stretch.time, core::value_of(time.block)});
    }

    const CoprocessorJob& job_;
    PreparedCheck& check_;
    ProgramRunner runner_;
    std::unique_ptr<DevicePipeline> device_;
    std::map<uint32_t, std::unique_ptr<DevicePipeline>> others_;
    CoprocessorRun made_;
};

core::Result<void> ParallelCoprocessor::open() {
    const core::CutModel& stock = runner_.machine().stock;
    FEELER_TRY(device_, DevicePipeline::with(job_.device, check_.run.setup, stock, job_.on_cycle,
                                             job_.on_circuit));
    for (const uint32_t elements : job_.other_elements) {
        hwsim::DeviceConfig config = job_.device;
        config.elements = elements;
        FEELER_TRY(others_[elements], DevicePipeline::with(config, check_.run.setup, stock));
    }
    if (job_.check.start_line.empty()) return {};
    return runner_.start_at(job_.check.start_line);
}

core::Result<void> ParallelCoprocessor::ask() {
    const auto block = runner_.next_block();
    if (!block) return {};
    if (auto pushed = device_->push(block->events, runner_.machine(), block->doubt); !pushed)
        return pushed;
    for (auto& [elements, device] : others_)
        if (auto pushed = device->push(block->events, runner_.machine(), block->doubt); !pushed)
            return pushed;
    return {};
}

core::Result<void> ParallelCoprocessor::finish() {
    if (auto finished = device_->finish(); !finished) return finished;
    made_.blocks = device_->blocks();
    made_.blocks.resize(check_.run.blocks.size());
    made_.totals = device_->totals();
    for (auto& [elements, device] : others_) {
        if (auto finished = device->finish(); !finished) return finished;
        std::vector<BlockCycles>& cycles = made_.cycles_by_elements[elements];
        for (const DeviceBlock& block : device->blocks())
            cycles.push_back({block.cycles, block.interval, block.lines});
        cycles.resize(made_.blocks.size());
    }
    return {};
}

core::Result<CoprocessorRun> ParallelCoprocessor::run() {
    const Stopwatch checking;
    if (auto opened = open(); !opened) return tl::unexpected(std::move(opened).error());
    do
        if (auto done = ask(); !done) return tl::unexpected(std::move(done).error());
    while (runner_.advance() && (!runner_.after_block || runner_.after_block(runner_.progress())));
    if (auto finished = finish(); !finished) return tl::unexpected(std::move(finished).error());
    check_.run.times.check = checking.seconds();
    runner_.conclude(false);
    made_.check = std::move(check_.run);
    return std::move(made_);
}

} // namespace

core::Result<CoprocessorRun> run_with_coprocessor(const CoprocessorJob& job) {
    FEELER_TRY(PreparedCheck check, prepare_check(job.check));
    return ParallelCoprocessor(job, check).run();
}

namespace {

BlockService service_of(const BlockCycles& cycles, uint32_t clock_mhz,
                        const ControlConfig& control) {
    const auto seconds = [&](uint64_t count) {
        return static_cast<double>(count) / (1e6 * clock_mhz);
    };
    return {.seconds = seconds(cycles.latency),
            .interval = seconds(cycles.interval),
            .making = static_cast<double>(cycles.lines) * control.line_time};
}

/// Whether no permit is late, given the times of a machine that never waits.
bool keeps_up(const std::vector<BlockTiming>& undisturbed, const std::vector<BlockCycles>& cycles,
              uint32_t clock_mhz, const ControlConfig& control) {
    PermitQueue queue;
    for (size_t i = 0; i < undisturbed.size(); ++i) {
        const BlockService service = service_of(cycles[i], clock_mhz, control);
        if (queue.next(service, undisturbed[i].asked) > undisturbed[i].due) return false;
    }
    return true;
}

} // namespace

std::vector<BlockService> services_of(const CoprocessorRun& run, uint32_t clock_mhz,
                                      const ControlConfig& control) {
    std::vector<BlockService> services;
    for (const DeviceBlock& block : run.blocks) {
        services.push_back(
            service_of({block.cycles, block.interval, block.lines}, clock_mhz, control));
        services.back().refused = !block.permit.permitted;
    }
    return services;
}

std::vector<DeviceFit> least_clocks(const CoprocessorRun& run, const ControlConfig& control) {
    if (run.cycles_by_elements.empty()) return {};
    const std::vector<BlockService> at_once(run.blocks.size());
    const std::vector<BlockTiming> undisturbed =
        timed_with_permits(run.plan, at_once, control).blocks;
    std::vector<DeviceFit> fits;
    for (const auto& [elements, cycles] : run.cycles_by_elements) {
        const auto enough =
            std::find_if(clocks.begin(), clocks.end(), [&, &cycles = cycles](uint32_t clock) {
                return keeps_up(undisturbed, cycles, clock, control);
            });
        fits.push_back({elements, enough == clocks.end() ? std::nullopt : std::optional(*enough)});
    }
    return fits;
}

std::optional<DeviceFit> smallest(const std::vector<DeviceFit>& fits) {
    std::optional<DeviceFit> best;
    for (const DeviceFit& fit : fits) {
        if (!fit.clock_mhz) continue;
        if (!best || fit.elements * *fit.clock_mhz < best->elements * *best->clock_mhz) best = fit;
    }
    return best;
}

} // namespace app

#include "app/session/coprocessor_run.h"

#include "app/session/conclusion.h"
#include "app/session/program_runner.h"
#include "app/session/stopwatch.h"

namespace app {
namespace {

/// A device and its driver. It stays where it is.
struct Bench {
    hwsim::EmulatedDevice device;
    std::optional<CoprocessorCheck> check;

    uint64_t cycle() const { return device.state.cycle; }
};

core::Result<std::unique_ptr<Bench>>
bench_with(const hwsim::DeviceConfig& config, const core::Setup& setup, const core::CutModel& stock,
           const std::function<void(const hwsim::CoprocessorState&)>& on_cycle) {
    auto bench = std::make_unique<Bench>();
    FEELER_TRY(bench->device, hwsim::emulated_device(config));
    FEELER_TRY(bench->check,
               CoprocessorCheck::with(hwsim::port_of(bench->device, on_cycle), setup, stock));
    return bench;
}

DeviceTotals totals_of(hwsim::EmulatedDevice& device) {
    DeviceTotals totals;
    for (uint32_t i = 0; i < hwsim::counter_count; ++i) {
        const uint32_t address = hwsim::address_of(static_cast<hwsim::Counter>(i));
        const uint64_t low = hwsim::read(device.state, device.config, address);
        totals.counters[i] =
            low | uint64_t{hwsim::read(device.state, device.config, address + 4)} << 32;
    }
    return totals;
}

core::Result<DeviceBlock> asked(Bench& bench, std::span<const core::Event> block,
                                const core::SimulatorState& before) {
    const uint64_t begin = bench.cycle();
    const hwsim::SearchSums sums = bench.device.state.searched;
    DeviceBlock found;
    FEELER_TRY(found.permit, bench.check->ask(block, before));
    found.cycles = bench.cycle() - begin;
    found.nodes = bench.device.state.searched.nodes - sums.nodes;
    found.pairs = bench.device.state.searched.pair_tests - sums.pair_tests;
    found.after = totals_of(bench.device);
    return found;
}

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
    void plan(const core::BlockTime& time) {
        for (const core::BlockStretch& stretch : time.stretches)
            if (stretch.time.duration > 0.0)
                made_.plan.push_back({stretch.time, core::value_of(time.block)});
    }

    const CoprocessorJob& job_;
    PreparedCheck& check_;
    ProgramRunner runner_;
    BlockRunner ahead_;
    std::unique_ptr<Bench> bench_;
    std::map<uint32_t, std::unique_ptr<Bench>> others_;
    CoprocessorRun made_;
};

core::Result<void> BesideCoprocessor::open() {
    std::function<void(const hwsim::CoprocessorState&)> on_cycle;
    if (job_.on_cycle)
        on_cycle = [this](const hwsim::CoprocessorState& state) {
            job_.on_cycle(made_.blocks.size(), state);
        };
    const core::CutModel& stock = runner_.place().machine.stock;
    FEELER_TRY(bench_, bench_with(job_.device, check_.run.setup, stock, on_cycle));
    for (const uint32_t elements : job_.other_elements) {
        hwsim::DeviceConfig config = job_.device;
        config.elements = elements;
        FEELER_TRY(others_[elements], bench_with(config, check_.run.setup, stock, {}));
    }
    return {};
}

core::Result<void> BesideCoprocessor::ask() {
    const RunPlace& place = runner_.place();
    const auto events = first_events(
        [&](const BlockVisit& look) { ahead_.visit_ahead(place.control, place.lowering, look); });
    if (!events) return {};
    FEELER_TRY(DeviceBlock asked_of_it, asked(*bench_, *events, place.machine));
    made_.blocks.push_back(std::move(asked_of_it));
    for (auto& [elements, bench] : others_) {
        FEELER_TRY(const DeviceBlock other, asked(*bench, *events, place.machine));
        made_.cycles_by_elements[elements].push_back(other.cycles);
    }
    return {};
}

core::Result<CoprocessorRun> BesideCoprocessor::run() {
    const Stopwatch checking;
    if (auto opened = open(); !opened) return tl::unexpected(std::move(opened).error());
    do
        if (auto done = ask(); !done) return tl::unexpected(std::move(done).error());
    while (runner_.advance() && (!runner_.after_block || runner_.after_block(runner_.progress())));
    made_.blocks.resize(check_.run.blocks.size());
    for (auto& [elements, cycles] : made_.cycles_by_elements) cycles.resize(made_.blocks.size());
    made_.totals = totals_of(bench_->device);
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

#include "app/coproc/device_judge.h"

#include <algorithm>
#include <deque>
#include <optional>

#include <fmt/format.h>

#include "app/coproc/device_check.h"
#include "core/base/rule_table.h"
#include "core/sim/verdict.h"
#include "hwsim/circuit_port.h"
#include "hwsim/coprocessor.h"

namespace app {
namespace {

using core::Verdict;

Verdict verdict_of(const QueriedPair& asked) {
    if (!asked.refused) return Verdict::clear;
    return asked.may_overlap || asked.allowance.distance <= core::resolution ? Verdict::collision
                                                                             : Verdict::violation;
}

core::PairClearance clearance_of(const QueriedPair& asked, double search_limit) {
    core::PairClearance pair{.pair = asked.pair, .allowance = asked.allowance};
    pair.lower = std::min(asked.lower, search_limit);
    pair.verdict = verdict_of(asked);
    return pair;
}

std::string nearness(const QueriedPair& asked) {
    if (asked.allowance.distance <= core::resolution) return "collide";
    if (asked.may_overlap)
        return fmt::format("overlap (minimum clearance {} mm)",
                           core::at_most(asked.allowance.distance));
    return fmt::format("may come within {} mm (minimum clearance {} mm)",
                       core::clearance_at_least(asked.lower),
                       core::at_most(asked.allowance.distance));
}

/// The worst refused pair; null if none was refused.
const QueriedPair* worst_of(const BlockPermit& permit) {
    const QueriedPair* worst = nullptr;
    const auto margin = [](const QueriedPair& pair) {
        return pair.lower - pair.allowance.distance;
    };
    for (const QueriedPair& pair : permit.pairs) {
        if (!pair.refused) continue;
        const bool is_worse =
            !worst || verdict_of(pair) > verdict_of(*worst)
            || (verdict_of(pair) == verdict_of(*worst) && margin(pair) < margin(*worst));
        if (is_worse) worst = &pair;
    }
    return worst;
}

core::Finding refusal(const core::Setup& setup, const BlockPermit& permit) {
    core::Finding finding;
    finding.rule = core::rule_id("refused");
    if (const QueriedPair* worst = worst_of(permit)) {
        finding.pair = {core::part_name(setup, worst->pair), core::body_name(setup, worst->pair)};
        finding.shortfall = std::max(0.0, worst->allowance.distance - worst->lower);
    }
    if (!permit.not_queried.empty() && permit.stop == hwsim::Stop::none) {
        finding.message = fmt::format("The coprocessor cannot check this block, so it gives no "
                                      "permit: {}.",
                                      permit.not_queried);
        finding.cure = "Check the block with the exact engine.";
    } else if (permit.stop == hwsim::Stop::violation && worst_of(permit)) {
        const bool is_stock = !worst_of(permit)->pair.fixture;
        finding.message = fmt::format(
            "The coprocessor refuses this block: its models of the {} and of {} {}.",
            finding.pair[0], is_stock ? "the stock" : finding.pair[1], nearness(*worst_of(permit)));
        finding.cure = "Check the block with the exact engine for the true clearance.";
    } else {
        finding.message = fmt::format("The coprocessor refuses this block because of a fault: {}.",
                                      hwsim::name_of(permit.stop));
        finding.cure = "Check the block with the exact engine.";
    }
    return finding;
}

} // namespace

struct DeviceJudge::State {
    const core::Setup& setup;
    hwsim::FunctionalDevice device; // the driver of the check refers to it
    std::optional<CoprocessorCheck> check = {};
};

DeviceJudge::DeviceJudge(std::unique_ptr<State> state) : state_(std::move(state)) {}
DeviceJudge::DeviceJudge(DeviceJudge&&) noexcept = default;
DeviceJudge& DeviceJudge::operator=(DeviceJudge&&) noexcept = default;
DeviceJudge::~DeviceJudge() = default;

core::Result<DeviceJudge> DeviceJudge::with(const core::Setup& setup, const core::CutModel& stock) {
    FEELER_TRY(hwsim::FunctionalDevice device, hwsim::functional_device({}));
    auto state = std::make_unique<State>(State{setup, std::move(device)});
    FEELER_TRY(state->check, CoprocessorCheck::with(hwsim::port_of(state->device), setup, stock,
                                                    QueryScope::everything));
    return DeviceJudge(std::move(state));
}

core::Result<core::Judgement> DeviceJudge::judge(std::span<const core::Event> block,
                                                 const core::SimulatorState& before,
                                                 const std::string& doubt) {
    FEELER_TRY(const BlockPermit permit, state_->check->ask(block, before, doubt));
    core::Judgement judgement;
    for (const QueriedPair& asked : permit.pairs) {
        judgement.pairs.push_back(clearance_of(asked, state_->setup.search_limit));
        judgement.runs_into_stock =
            judgement.runs_into_stock
            || (asked.refused && asked.pair == core::Pair{core::PartKind::flutes});
    }
    if (permit.permitted) return judgement;
    judgement.verdict = Verdict::undecided;
    judgement.checked = permit.not_queried.empty() || worst_of(permit);
    const bool is_only_doubted = permit.not_queried.empty() && permit.stop == hwsim::Stop::none;
    if (!is_only_doubted && (!permit.is_reported || permit.stop != hwsim::Stop::none))
        judgement.finding = refusal(state_->setup, permit);
    return judgement;
}

namespace {

using core::Result;

bool is_of(const PushedBlock& pushed, uint32_t sequence) {
    return sequence - pushed.first < pushed.asked.size();
}

/// The last segment of a block; the one before its first if nothing was asked.
uint32_t last_of(const PushedBlock& pushed) {
    return pushed.first + static_cast<uint32_t>(pushed.asked.size()) - 1;
}

} // namespace

struct DevicePipeline::State {
    /// A block without an answer.
    struct Pending {
        std::vector<core::Event> events;
        core::SimulatorState before;
        std::string doubt;
        bool is_pushed = false;
        uint64_t begin = 0; // cycle of its first word
        PushedBlock pushed = {};
        DeviceBlock block = {}; // results so far
        uint64_t end = 0;       // cycle of its last answer
    };
    /// A segment that the device has finished.
    struct Finished {
        uint32_t sequence = 0;
        uint64_t cycle = 0;
        hwsim::SearchCounts counts;
        DeviceTotals after;
    };

    State(hwsim::EmulatedDevice device, const core::Setup& setup)
        : device_(std::move(device)), setup_(&setup) {}

    core::Result<void> push(std::span<const core::Event> block, const core::SimulatorState& before,
                            const std::string& doubt);
    core::Result<void> finish();
    DeviceTotals totals();

    void note(const hwsim::CoprocessorState& state);
    /// Pushes and collects until every block is in the device.
    core::Result<void> settle();
    core::Result<void> ask(Pending& pending);
    /// Assigns finished segments to their blocks, and moves completed blocks to the list.
    void collect();
    bool is_answered(const Pending& pending) const;
    /// The report of the device at the time when it had permitted a block.
    static hwsim::DeviceReport permitted(const Pending& pending);
    /// Completes the oldest block with its answer.
    void close(const hwsim::DeviceReport& report);
    /// Handles a stop: the block that caused it is refused, and the blocks after it are asked
    /// again.
    void take_stop();

    hwsim::EmulatedDevice device_;
    const core::Setup* setup_;
    hwsim::CircuitDifference difference_ = std::make_shared<std::string>();
    std::optional<CoprocessorCheck> check_ = {};
    std::function<void(const BlocksInDevice&, const hwsim::CoprocessorState&)> on_cycle_ = {};
    std::deque<Pending> pending_ = {};
    std::vector<Finished> finished_ = {}; // and not yet assigned to their blocks
    std::vector<DeviceBlock> blocks_ = {};
    uint64_t last_end_ = 0;
};

DevicePipeline::DevicePipeline(std::unique_ptr<State> state) : state_(std::move(state)) {}
DevicePipeline::~DevicePipeline() = default;

Result<std::unique_ptr<DevicePipeline>> DevicePipeline::with(
    const hwsim::DeviceConfig& config, const core::Setup& setup, const core::CutModel& stock,
    std::function<void(const BlocksInDevice&, const hwsim::CoprocessorState&)> on_cycle,
    bool on_circuit) {
    FEELER_TRY(hwsim::EmulatedDevice device, hwsim::emulated_device(config));
    auto state = std::make_unique<State>(std::move(device), setup);
    state->on_cycle_ = std::move(on_cycle);
    const auto note = [&pipeline = *state](const auto& now) { pipeline.note(now); };
    hwsim::DevicePort port = hwsim::port_of(state->device_, note);
    if (on_circuit) {
        FEELER_TRY(port, hwsim::port_with_circuit(state->device_, note, state->difference_));
    }
    FEELER_TRY(state->check_, CoprocessorCheck::with(std::move(port), setup, stock));
    return std::unique_ptr<DevicePipeline>(new DevicePipeline(std::move(state)));
}

Result<void> DevicePipeline::push(std::span<const core::Event> block,
                                  const core::SimulatorState& before, const std::string& doubt) {
    return state_->push(block, before, doubt);
}

Result<void> DevicePipeline::finish() { return state_->finish(); }

const std::vector<DeviceBlock>& DevicePipeline::blocks() const { return state_->blocks_; }

DeviceTotals DevicePipeline::totals() { return state_->totals(); }

void DevicePipeline::State::note(const hwsim::CoprocessorState& state) {
    const hwsim::Retired& retired = state.retired;
    if (retired.valid && retired.segment.kind == hwsim::SegmentKind::permit)
        finished_.push_back(
            {retired.segment.sequence, state.cycle, retired.answer.counts, totals()});
    if (!on_cycle_) return;
    const size_t newest = blocks_.size() + (pending_.empty() ? 0 : pending_.size() - 1);
    on_cycle_({blocks_.size(), newest}, state);
}

Result<void> DevicePipeline::State::push(std::span<const core::Event> block,
                                         const core::SimulatorState& before,
                                         const std::string& doubt) {
    pending_.push_back({.events = {block.begin(), block.end()}, .before = before, .doubt = doubt});
    return settle();
}

Result<void> DevicePipeline::State::finish() {
    while (true) {
        if (auto settled = settle(); !settled) return settled;
        if (!difference_->empty())
            return core::fail(core::ErrorCode::invalid_value,
                              "the circuit and the emulator disagree: " + *difference_);
        if (pending_.empty()) return {};
        check_->report(); // advances the device by some cycles, and resets its watchdog
    }
}

Result<void> DevicePipeline::State::settle() {
    while (true) {
        collect();
        if (device_.state.permits.stopped != hwsim::Stop::none) {
            take_stop();
            continue;
        }
        const auto next = std::find_if(pending_.begin(), pending_.end(),
                                       [](const Pending& one) { return !one.is_pushed; });
        if (next == pending_.end()) return {};
        if (auto asked = ask(*next); !asked) return asked;
    }
}

Result<void> DevicePipeline::State::ask(Pending& pending) {
    pending.begin = pending.end = device_.state.cycle;
    const uint64_t before = check_->lines_made();
    FEELER_TRY(pending.pushed, check_->push(pending.events, pending.before, pending.doubt));
    pending.block.lines = check_->lines_made() - before;
    pending.is_pushed = true;
    return {};
}

void DevicePipeline::State::collect() {
    size_t taken = 0;
    for (const Finished& one : finished_) {
        const auto owner = std::find_if(pending_.begin(), pending_.end(), [&](const Pending& p) {
            return p.is_pushed && is_of(p.pushed, one.sequence);
        });
        if (owner == pending_.end()) break; // its block is still being pushed
        owner->block.nodes += one.counts.nodes;
        owner->block.pairs += one.counts.pair_tests;
        owner->end = one.cycle;
        owner->block.after = one.after;
        ++taken;
    }
    finished_.erase(finished_.begin(), finished_.begin() + static_cast<std::ptrdiff_t>(taken));
    while (!pending_.empty() && is_answered(pending_.front())) close(permitted(pending_.front()));
}

hwsim::DeviceReport DevicePipeline::State::permitted(const Pending& pending) {
    return {.permitted = last_of(pending.pushed)};
}

bool DevicePipeline::State::is_answered(const Pending& pending) const {
    if (!pending.is_pushed) return false;
    const uint32_t permitted = device_.state.permits.permit_sequence;
    return static_cast<int32_t>(permitted - last_of(pending.pushed)) >= 0;
}

void DevicePipeline::State::close(const hwsim::DeviceReport& report) {
    Pending& pending = pending_.front();
    if (pending.pushed.asked.empty() && !blocks_.empty())
        pending.block.after = blocks_.back().after;
    pending.block.permit = answered(std::move(pending.pushed), report, *setup_);
    pending.block.cycles = pending.end - pending.begin;
    pending.block.interval =
        pending.end - std::min(pending.end, std::max(last_end_, pending.begin));
    last_end_ = std::max(last_end_, pending.end);
    blocks_.push_back(std::move(pending.block));
    pending_.pop_front();
}

void DevicePipeline::State::take_stop() {
    const hwsim::DeviceReport report = check_->report();
    // All blocks that were permitted are closed, so the oldest one has stopped the device, or is
    // the first one that a fault leaves without a permit.
    if (!pending_.empty()) {
        if (report.stop != hwsim::Stop::violation) {
            pending_.front().end = device_.state.cycle;
            pending_.front().block.after = totals();
        }
        close(report);
    }
    for (Pending& again : pending_) {
        again.is_pushed = false;
        again.block = {};
    }
    finished_.clear();
    check_->recover();
}

DeviceTotals DevicePipeline::State::totals() {
    DeviceTotals totals;
    const uint32_t high_word =
        device_.state.host.high_word; // preserved: the driver may be between two reads
    for (uint32_t i = 0; i < hwsim::counter_count; ++i) {
        const uint32_t address = hwsim::address_of(static_cast<hwsim::Counter>(i));
        const uint64_t low = hwsim::read(device_.state, device_.config, address);
        totals.counters[i] =
            low | uint64_t{hwsim::read(device_.state, device_.config, address + 4)} << 32;
    }
    device_.state.host.high_word = high_word;
    return totals;
}

void add(EngineAgreement& agreement, const BlockPermit& permit, const core::BlockResult& exact) {
    const bool violates =
        std::any_of(exact.pairs.begin(), exact.pairs.end(), [](const core::PairClearance& pair) {
            return pair.verdict >= core::Verdict::violation;
        });
    ++agreement.blocks;
    agreement.violations += violates;
    agreement.refused += !permit.permitted;
    agreement.not_queried += !permit.is_checked();
    agreement.missed += violates && permit.permitted;
    agreement.unproven += permit.permitted && exact.verdict == Verdict::undecided;
    if (violates || permit.permitted || !permit.is_checked()) return;
    agreement.undecided += exact.verdict == core::Verdict::undecided;
    agreement.false_alarms += exact.verdict == core::Verdict::clear;
}

} // namespace app

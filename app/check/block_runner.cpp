#include "app/check/block_runner.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "app/check/block_events.h"
#include "app/check/dog_legs.h"
#include "app/check/over_travel.h"
#include "app/check/prepared_check.h"
#include "app/check/run_ahead.h"
#include "app/check/run_state.h"
#include "core/base/rule_table.h"
#include "core/base/text.h"
#include "gcode/language/error_rules.h"
#include "gcode/text/source.h"

namespace app {
namespace {

/// Makes a sentence of a text: adds a full stop, and a capital unless the text begins with a name.
std::string as_sentence(std::string text) {
    const auto is_small = [&](size_t i) {
        return i < text.size()
               && (std::islower(static_cast<unsigned char>(text[i])) || text[i] == ' ');
    };
    if (is_small(0) && is_small(1)) text[0] = core::upper(text[0]);
    if (!text.empty() && text.back() != '.') text += '.';
    return text;
}

} // namespace

core::Finding finding_of(const core::Setup& setup, const gcode::Warning& warning) {
    core::Finding finding;
    finding.rule = warning.rule;
    if (warning.severity == gcode::Severity::note) finding.severity = core::Severity::note;
    core::settle_severity(setup, finding);
    finding.message = as_sentence(warning.message);
    finding.cure = warning.cure;
    return finding;
}

std::optional<core::Finding> alarm_finding(const core::Setup& setup, const core::Error& error) {
    core::Finding finding;
    finding.rule = gcode::rule_of(error);
    if (finding.rule.empty()) return std::nullopt;
    finding.severity = core::severity_of(setup, finding.rule);
    if (finding.severity == core::Severity::off) return std::nullopt;
    finding.message = error.message + ". The control stops here with an alarm.";
    finding.cure = finding.rule == core::rule_id("no-feed")
                       ? "Add F to this block, in the unit of the feed mode."
                       : "Check the end point, centre and plane of this arc.";
    return finding;
}

BlockRunner::BlockRunner(const PreparedCheck& check)
    : check_(check),
      setup_(&check.run.setup),
      interpreter_(*check.library, check.file.environment),
      next_(gcode::initial_state(check.file.environment)) {}

BlockRunner::~BlockRunner() = default;

void BlockRunner::use(const core::Setup& setup) {
    work_alone();
    setup_ = &setup;
    dog_legs_.reset();
}

std::optional<core::Error> BlockRunner::refusal(const gcode::BlockCommands& block,
                                                const gcode::Lowering& lowering) const {
    if (lowering.moved_tilted && check_.file.has_axes)
        return core::Error{core::ErrorCode::unsupported,
                           {.line = block.line, .column = 1},
                           "this block moves in a tilted plane or with a tilted tool, but the "
                           "machine in the set-up has no rotary axes: add them as [[axis]]",
                           std::string(block.file)};
    if (!lowering.other_axis || !check_.file.has_axes) return std::nullopt;
    return core::Error{core::ErrorCode::unsupported,
                       {.line = block.line, .column = 1},
                       fmt::format("this block moves axis {}, which the machine in the set-up does "
                                   "not have: add an [[axis]] of that name",
                                   gcode::axis_letters[*lowering.other_axis]),
                       std::string(block.file)};
}

void BlockRunner::add_warnings(const gcode::BlockCommands& block, const RunState& state,
                               std::vector<core::Finding>& findings) const {
    for (const gcode::Warning& warning : block.warnings) {
        // A work offset in the set-up counts as set even if it is all zeros, and assumed ones do.
        const auto active = static_cast<int>(state.control.modal.offsets.active);
        if (warning.rule == core::rule_id("work-offset-unset")
            && (check_.file.infers_frame || check_.file.offsets_set.contains(active)))
            continue;
        core::Finding finding = finding_of(*setup_, warning);
        finding.block = block.block;
        if (finding.severity != core::Severity::off) findings.push_back(std::move(finding));
    }
}

core::PathCertainty BlockRunner::certainty(const gcode::BlockCommands& block,
                                           std::span<const core::Event> events, RunState& state,
                                           std::vector<core::Finding>& findings) const {
    const auto axis = check_.file.has_axes ? std::nullopt : displaced_axis(events);
    if (!axis) return block.path;
    const auto certainty = std::max(block.path, core::PathCertainty::pose_unknown);
    if (std::exchange(state.said_displaced, true)) return certainty;
    const bool turns = core::is_rotary(*axis);
    core::Finding finding;
    finding.rule = core::rule_id("undecided");
    finding.block = block.block;
    finding.message = fmt::format(
        "Axis {} {}. This block and all others with such an axis away from 0 are not checked, and "
        "what they cut stays in the stock.",
        core::axis_letters[*axis],
        turns ? "turns the work about a centre that is not stated"
              : "is not described, so it is unknown what it moves");
    finding.cure =
        fmt::format("Describe the machine in a set-up, with {} as an [[axis]]{}.",
                    core::axis_letters[*axis], turns ? " and a point on its axis of rotation" : "");
    core::settle_severity(*setup_, finding);
    if (finding.severity != core::Severity::off) findings.push_back(std::move(finding));
    return certainty;
}

void BlockRunner::use_threads(unsigned threads, size_t first) {
    // The run itself is the limit: with more threads the others only wait.
    constexpr unsigned most_threads = 8;
    work_alone();
    threads_ = std::min(threads, most_threads);
    first_pause_ = pause_ = first;
}

void BlockRunner::work_alone() {
    if (!ahead_) return;
    ahead_.reset();
    is_ahead_over_ = false;
    alone_ = 0;
    // Where little can be foreseen, try less often.
    constexpr size_t longest = 1 << 16;
    pause_ = served_ > 4 * pause_ ? first_pause_ : std::min(2 * pause_, longest);
}

void BlockRunner::stop_reading_ahead() {
    ahead_->halt();
    is_ahead_over_ = true;
}

ReadBlock* BlockRunner::read_ahead(RunState& state) {
    if (threads_ < 2) return nullptr;
    if (is_ahead_over_ || (ahead_ && ahead_of_ != &state)) work_alone();
    if (!ahead_) {
        // Starting takes time for each tile of the stock.
        constexpr size_t tiles_to_double = 12'800;
        const size_t tiles = state.machine.stock.columns.tile_count();
        const size_t pause = pause_ + pause_ * tiles / tiles_to_double;
        const bool is_plain = state.machine.spread.none() && !state.lengths.is_open;
        if (++alone_ <= pause || !is_plain) return nullptr;
    }
    ReadBlock* block = nullptr;
    try {
        if (!ahead_) {
            ahead_ = std::make_unique<RunAhead>(check_, *setup_, state, threads_);
            ahead_of_ = &state;
            served_ = 0;
        }
        block = ahead_->next(state.machine.stock);
    } catch (const std::bad_alloc&) {
        threads_ = 1; // the memory is enough for the run alone
    }
    if (!block) {
        work_alone();
        return nullptr;
    }
    ++served_;
    ++foreseen_;
    return block;
}

core::Result<std::optional<BlockStep>> BlockRunner::step(RunState& state) {
    auto done = run_next(state);
    if (!done || !*done) work_alone();
    return done;
}

core::Result<std::optional<BlockStep>> BlockRunner::run_next(RunState& state) {
    const auto failed = [&](core::Error error) {
        return tl::unexpected(core::in_file(std::move(error), check_.program->file));
    };
    ReadBlock* const ahead = read_ahead(state);
    gcode::InterpreterState& after = ahead ? ahead->control : next_;
    core::Result<const gcode::BlockCommands*> read = nullptr;
    if (ahead) {
        read = &ahead->block;
    } else {
        after = state.control;
        read = interpreter_.next(after);
    }
    if (after_reading && after.readings->met.size() > state.control.readings->met.size()) {
        if (ahead) stop_reading_ahead(); // whoever is called may use the library
        after_reading(state, after);
    }
    if (!read) return failed(read.error());
    if (!*read) {
        std::swap(state.control, after);
        return std::nullopt;
    }
    const gcode::BlockCommands& block = **read;
    gcode::Lowering lowering = ahead ? ahead->lowering : state.lowering;
    std::vector<core::Event> own_events;
    if (!ahead) own_events = events_of(*setup_, block, lowering, check_.file.speed_by_hand);
    const std::vector<core::Event>& events = ahead ? ahead->events : own_events;
    if (auto refused = refusal(block, lowering)) return failed(*std::move(refused));
    auto judged =
        judge ? judge(events, state.machine, doubt_about(block, events, check_.file.has_axes))
              : core::Judgement();
    if (!judged)
        return failed({judged.error().code,
                       {.line = block.line, .column = 1},
                       std::move(judged).error().message,
                       std::string(block.file)});
    for (const size_t move : fixture_moves_of(*setup_, block)) state.moves_made.insert(move);
    BlockStep step{{block.block,
                    block.line,
                    std::string(block.text),
                    std::string(block.file),
                    block.calls,
                    {}}};
    const core::PathCertainty path = certainty(block, events, state, step.findings);
    const core::BlockEvents of_block{block.block,
                                     block.is_cycle,
                                     events,
                                     block.goes_home,
                                     block.in_machine,
                                     path,
                                     judge ? &*judged : nullptr};
    track_length(state.lengths, *setup_, of_block, block.warnings, state.machine);
    if (before_block) {
        if (state.lengths.is_open && ahead) stop_reading_ahead(); // it may read the program
        before_block(block, state);
    }
    std::swap(state.control, after);
    state.lowering = lowering;
    std::optional<core::BlockResult> bent;
    if (follows_dog_legs) {
        if (!dog_legs_) dog_legs_ = std::make_unique<const DogLegTrial>(*setup_);
        bent = dog_legs_->run(of_block, state.machine);
    }
    core::BlockEvents with_cuts = of_block;
    with_cuts.threads = threads_;
    if (ahead) with_cuts.replay = &ahead_->cuts(state.machine.stock);
    step.checked.result = core::run_block(*setup_, with_cuts, state.machine);
    is_ahead_over_ = is_ahead_over_ || (ahead && !ahead_->went_as_foreseen());
    if (bent) step.as_dog_legs = worse_than(step.checked.result, *bent);
    cure_machine_moves(step.checked.result.findings, block, check_.file.environment,
                       lowering.offsets);
    add_warnings(block, state, step.findings);
    for (core::Finding& finding : step.checked.result.findings) step.findings.push_back(finding);
    if (path < core::PathCertainty::pose_unknown)
        track_offsets(state.offsets, *setup_, lowering.offsets, of_block, state.machine);
    else
        state.offsets[lowering.offsets.active].gap = 0.0; // it may cut the stock
    note_feeds(state.feeds, *setup_, state.control.modal, of_block, state.machine);
    core::add_block(state.clock, of_block, step.timed);
    return step;
}

void BlockRunner::visit_ahead(gcode::InterpreterState control, gcode::Lowering lowering,
                              const BlockVisit& visit) {
    work_alone();
    while (true) {
        const auto next = interpreter_.next(control);
        if (!next || !*next) return;
        if (!visit(**next, events_of(*setup_, **next, lowering, check_.file.speed_by_hand))) return;
    }
}

} // namespace app

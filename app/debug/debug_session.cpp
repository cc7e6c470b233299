#include "app/debug/debug_session.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/check/run_state.h"
#include "app/debug/inspected_value.h"
#include "app/debug/recorded_run.h"
#include "app/setup/setup_file.h"
#include "gcode/exec/interpreter.h"
#include "gcode/exec/restart.h"
#include "gcode/text/program_text.h"
#include "gcode/text/source.h"

namespace app {

/// Follows the state of the control along a record, without simulating motion.
///
/// Cost: a few microseconds per block, far less than running the block.
class ControlWalk {
public:
    /// Starts at a position. The run must outlive the walk and must not change meanwhile.
    ControlWalk(RecordedRun& run, size_t next_block);

    size_t next_block() const { return next_block_; }
    const gcode::InterpreterState& control() const { return control_; }

    /// Advances by one block. The record must contain it.
    void advance();

private:
    RecordedRun& run_;
    size_t next_block_;
    gcode::Interpreter interpreter_;
    gcode::InterpreterState control_;
};

ControlWalk::ControlWalk(RecordedRun& run, size_t next_block)
    : run_(run),
      next_block_(next_block),
      interpreter_(run.library(), run.check().file.environment),
      control_(run.state_at(next_block)->control) {}

void ControlWalk::advance() {
    run_.work_alone();
    [[maybe_unused]] const auto block = interpreter_.next(control_);
    assert(block && *block);
    ++next_block_;
    const auto& changes = run_.changes();
    if (std::any_of(changes.begin(), changes.end(),
                    [this](const AppliedChange& made) { return made.block == next_block_; }))
        control_ = run_.state_at(next_block_)->control;
}

/// One walk of a session, forwards or back, to the first position that has a reason to stop.
class SessionWalk {
public:
    explicit SessionWalk(DebugSession& session);

    /// The goal of a walk, besides breakpoints and watches. `is_reached` is called for every block
    /// on the way, in order, with the control before the block if `uses_control`.
    struct Goal {
        std::function<bool(size_t block, const gcode::InterpreterState* control)> is_reached;
        bool uses_control = false;
        StopReason reason = StopReason::found;
    };
    Stop forwards(const Goal& goal);
    Stop backwards(const Goal& goal);

    /// Whether a block has a finding of severity error or is not proven clear.
    bool offends(size_t block);
    bool changes_tool(size_t block) const;
    /// The depth of subprogram calls at a block; 0 for an unknown block.
    size_t depth(size_t block) const;

private:
    /// The findings about a block.
    struct Findings {
        std::vector<std::string> rules;
        bool has_error = false;
    };

    bool uses_control(const Goal& goal) const;
    bool is_interrupted() const;
    Stop stop_at(size_t next_block, Stop stop);
    /// Stops after the last block that can be run.
    Stop stop_at_end(size_t next_block);
    /// The first breakpoint whose criteria a block meets; ignore counts are not considered.
    Breakpoint* breakpoint_at(size_t block, const gcode::InterpreterState* control);
    /// As breakpoint_at, for a walk forwards: applies and decrements ignore counts.
    Breakpoint* breakpoint_reached(size_t block, const gcode::InterpreterState* control);
    bool stops_before(const Breakpoint& breakpoint, size_t block,
                      const gcode::InterpreterState* control);
    /// The reason to stop before a block on a walk back, if any.
    std::optional<Stop> found_going_back(size_t block, const gcode::InterpreterState* control,
                                         const Goal& goal);
    /// The values of all watches.
    std::vector<InspectedValue> values(const gcode::InterpreterState* control) const;
    std::optional<Stop> changed_watch(const std::vector<InspectedValue>& before,
                                      const std::vector<InspectedValue>& after) const;
    /// The last position in first .. last at which a walk back stops.
    std::optional<std::pair<size_t, Stop>> last_stop(size_t first, size_t last, const Goal& goal);
    const Findings* findings_of(size_t block);

    DebugSession& session_;
    std::map<uint32_t, Findings> findings_ = {};
    size_t findings_read_ = 0;
    bool read_complete_ = false;
};

SessionWalk::SessionWalk(DebugSession& session) : session_(session) {}

size_t SessionWalk::depth(size_t block) const {
    const auto& blocks = session_.record().blocks;
    return block < blocks.size() ? blocks[block].calls.size() : 0;
}

bool SessionWalk::changes_tool(size_t block) const {
    const CheckRun& record = session_.record();
    if (block >= session_.run_->last_position()) return false; // the block is not run
    const auto before =
        block == 0 ? record.setup.tool_at_start : record.blocks[block - 1].result.tool;
    return record.blocks[block].result.tool != before;
}

const SessionWalk::Findings* SessionWalk::findings_of(size_t block) {
    const CheckRun& record = session_.record();
    // In a complete record the findings have another order, and some are merged into others.
    if (read_complete_ != session_.is_recorded() || findings_read_ > record.findings.size()) {
        findings_.clear();
        findings_read_ = 0;
        read_complete_ = session_.is_recorded();
    }
    const auto read = [&](const core::Finding& finding, bool is_reported) {
        if (!finding.block) return;
        Findings& of_block = findings_[core::value_of(*finding.block)];
        of_block.rules.push_back(finding.rule);
        of_block.has_error |= is_reported && finding.severity == core::Severity::error;
    };
    if (findings_read_ == 0)
        for (const core::Finding& finding : record.combined_findings) read(finding, false);
    for (; findings_read_ < record.findings.size(); ++findings_read_)
        read(record.findings[findings_read_], true);
    const auto found = findings_.find(static_cast<uint32_t>(block));
    return found == findings_.end() ? nullptr : &found->second;
}

bool SessionWalk::offends(size_t block) {
    const Findings* findings = findings_of(block);
    return (findings && findings->has_error)
           || session_.record().blocks[block].result.verdict != core::Verdict::clear;
}

bool SessionWalk::uses_control(const Goal& goal) const {
    const auto asks = [](const Breakpoint& point) {
        return point.enabled && point.condition && point.condition->uses_control();
    };
    const auto is_on = [](const Watch& watch) { return watch.enabled; };
    return goal.uses_control
           || std::any_of(session_.breakpoints_.begin(), session_.breakpoints_.end(), asks)
           || std::any_of(session_.watches_.begin(), session_.watches_.end(), is_on);
}

bool SessionWalk::is_interrupted() const {
    return session_.is_interrupted && session_.is_interrupted();
}

bool SessionWalk::stops_before(const Breakpoint& breakpoint, size_t block,
                               const gcode::InterpreterState* control) {
    const CheckRun& record = session_.record();
    if (!breakpoint.enabled) return false;
    if (breakpoint.line && record.blocks.line(block) != *breakpoint.line) return false;
    const CheckedBlock at = record.blocks[block];
    if (breakpoint.line && at.file != breakpoint.file) return false;
    // With a condition, any block with the tool may meet it; a tool change has no clearance.
    const bool only_at_change = breakpoint.tool && !breakpoint.condition;
    if (only_at_change && !changes_tool(block)) return false;
    if (breakpoint.tool && at.result.tool != breakpoint.tool) return false;
    if (!breakpoint.rule.empty()) {
        const Findings* findings = findings_of(block);
        const bool any = breakpoint.rule == "finding";
        if (!findings
            || (!any
                && std::find(findings->rules.begin(), findings->rules.end(), breakpoint.rule)
                       == findings->rules.end()))
            return false;
    }
    return !breakpoint.condition
           || breakpoint.condition->holds({record, block, control, &session_.environment()});
}

Breakpoint* SessionWalk::breakpoint_at(size_t block, const gcode::InterpreterState* control) {
    for (Breakpoint& breakpoint : session_.breakpoints_)
        if (stops_before(breakpoint, block, control)) return &breakpoint;
    return nullptr;
}

Breakpoint* SessionWalk::breakpoint_reached(size_t block, const gcode::InterpreterState* control) {
    for (Breakpoint& breakpoint : session_.breakpoints_) {
        if (!stops_before(breakpoint, block, control)) continue;
        if (breakpoint.ignore == 0) return &breakpoint;
        --breakpoint.ignore;
    }
    return nullptr;
}

std::vector<InspectedValue> SessionWalk::values(const gcode::InterpreterState* control) const {
    std::vector<InspectedValue> values;
    for (const Watch& watch : session_.watches_) {
        const bool is_asked = watch.enabled && control;
        values.push_back(is_asked ? value_of(watch.expression, *control, session_.environment())
                                        .value_or(InspectedValue{})
                                  : InspectedValue{});
    }
    return values;
}

std::optional<Stop> SessionWalk::changed_watch(const std::vector<InspectedValue>& before,
                                               const std::vector<InspectedValue>& after) const {
    for (size_t i = 0; i < before.size(); ++i) {
        if (before[i] == after[i]) continue;
        Watch& watch = session_.watches_[i];
        return Stop{StopReason::watch, watch.id,
                    fmt::format("{}: {} -> {}", watch.expression, before[i].text, after[i].text)};
    }
    return std::nullopt;
}

Stop SessionWalk::stop_at(size_t next_block, Stop stop) {
    [[maybe_unused]] const auto gone = session_.go_to(next_block);
    if (stop.reason == StopReason::watch)
        for (Watch& watch : session_.watches_)
            if (watch.id == stop.id) ++watch.hits;
    if (stop.reason != StopReason::breakpoint) return stop;
    for (Breakpoint& breakpoint : session_.breakpoints_)
        if (breakpoint.id == stop.id) ++breakpoint.hits;
    std::erase_if(session_.breakpoints_, [&](const Breakpoint& breakpoint) {
        return breakpoint.id == stop.id && breakpoint.temporary;
    });
    return stop;
}

Stop SessionWalk::stop_at_end(size_t next_block) {
    return stop_at(next_block, {session_.record().stopped ? StopReason::error : StopReason::end});
}

Stop SessionWalk::forwards(const Goal& goal) {
    std::optional<ControlWalk> walk;
    if (uses_control(goal)) walk.emplace(*session_.run_, session_.at_);
    std::vector<InspectedValue> before = values(walk ? &walk->control() : nullptr);
    for (size_t next_block = session_.at_ + 1;; ++next_block) {
        if (!session_.knows(next_block - 1)) return stop_at_end(next_block - 1);
        if (walk) walk->advance();
        const gcode::InterpreterState* control = walk ? &walk->control() : nullptr;
        std::vector<InspectedValue> after = values(control);
        if (const auto changed = changed_watch(before, after)) return stop_at(next_block, *changed);
        before = std::move(after);
        // The block of an alarm is not run, but it may be the goal of the walk.
        const bool is_run = session_.knows(next_block);
        if (next_block == session_.record().blocks.size()) return stop_at_end(next_block);
        if (const Breakpoint* breakpoint = breakpoint_reached(next_block, control))
            return stop_at(next_block, {StopReason::breakpoint, breakpoint->id});
        if (goal.is_reached && goal.is_reached(next_block, control))
            return stop_at(next_block, {goal.reason});
        if (!is_run) return stop_at_end(next_block);
        if (is_interrupted()) return stop_at(next_block, {StopReason::interrupted});
    }
}

std::optional<Stop> SessionWalk::found_going_back(size_t block,
                                                  const gcode::InterpreterState* control,
                                                  const Goal& goal) {
    if (const Breakpoint* breakpoint = breakpoint_at(block, control))
        return Stop{StopReason::breakpoint, breakpoint->id};
    if (goal.is_reached && goal.is_reached(block, control)) return Stop{goal.reason};
    return std::nullopt;
}

std::optional<std::pair<size_t, Stop>> SessionWalk::last_stop(size_t first, size_t last,
                                                              const Goal& goal) {
    std::optional<std::pair<size_t, Stop>> found;
    ControlWalk walk(*session_.run_, first);
    for (size_t next_block = first; next_block <= last; ++next_block) {
        if (const auto stop = found_going_back(next_block, &walk.control(), goal))
            found.emplace(next_block, *stop);
        const std::vector<InspectedValue> before = values(&walk.control());
        walk.advance();
        if (const auto changed = changed_watch(before, values(&walk.control())))
            found.emplace(next_block, *changed);
    }
    return found;
}

Stop SessionWalk::backwards(const Goal& goal) {
    const bool with_control = uses_control(goal);
    size_t unexamined = session_.at_; // positions from here on have been examined
    while (unexamined > 0) {
        const size_t last = unexamined - 1;
        // The control can only be followed forwards, so start at the previous keyframe.
        const size_t first = with_control ? session_.run_->keyframe_before(last) : last;
        if (with_control) {
            if (const auto found = last_stop(first, last, goal))
                return stop_at(found->first, found->second);
        } else if (const auto stop = found_going_back(last, nullptr, goal)) {
            return stop_at(last, *stop);
        }
        unexamined = first;
        if (is_interrupted()) return stop_at(unexamined, {StopReason::interrupted});
    }
    return stop_at(0, {StopReason::beginning});
}

core::Result<std::unique_ptr<DebugSession>> DebugSession::open(const CheckJob& job,
                                                               size_t memory_budget) {
    FEELER_TRY(PreparedCheck check, read_check(job));
    return open(job, std::move(check), memory_budget);
}

core::Result<std::unique_ptr<DebugSession>>
DebugSession::open(const CheckJob& job, PreparedCheck check, size_t memory_budget) {
    FEELER_TRY(auto run, RecordedRun::open(job, std::move(check), memory_budget));
    return std::unique_ptr<DebugSession>(new DebugSession(std::move(run)));
}

DebugSession::DebugSession(std::unique_ptr<RecordedRun> run)
    : run_(std::move(run)), state_(std::make_unique<RunState>(*run_->state_at(0))) {}

DebugSession::~DebugSession() = default;

const CheckRun& DebugSession::record() const { return run_->record(); }

bool DebugSession::is_recorded() const { return run_->is_complete(); }

double DebugSession::recorded_fraction() const { return run_->fraction(); }

const gcode::Program& DebugSession::program() const { return run_->program(); }

const SetupFile& DebugSession::setup_file() const { return run_->check().file; }

const gcode::Environment& DebugSession::environment() const { return setup_file().environment; }

const core::Setup& DebugSession::setup_at(size_t block) const { return run_->setup_at(block); }

size_t DebugSession::keyframe_count() const { return run_->keyframe_count(); }

size_t DebugSession::keyframe_memory() const { return run_->keyframe_memory(); }

void DebugSession::visit_ahead(const BlockVisit& visit) { run_->visit_ahead(at_, *state_, visit); }

const gcode::InterpreterState& DebugSession::control() const { return state_->control; }

std::optional<core::ToolNumber> DebugSession::tool() const { return state_->machine.tool; }

const core::AxisPosition& DebugSession::position() const { return state_->machine.position; }

const core::CutModel& DebugSession::stock() const { return state_->machine.stock; }

const std::vector<bool>& DebugSession::mounted_fixtures() const {
    return state_->machine.mounted_fixtures;
}

const std::vector<AppliedChange>& DebugSession::changes() const { return run_->changes(); }

bool DebugSession::record_for(double seconds) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (run_->advance())
        if (Clock::now() >= end) return true;
    return false;
}

bool DebugSession::knows(size_t block) {
    while (run_->last_position() <= block && run_->advance()) {
    }
    return block < run_->last_position();
}

core::Result<bool> DebugSession::reaches(size_t block) {
    while (run_->last_position() <= block && run_->advance())
        if (is_interrupted && is_interrupted())
            return core::fail(core::ErrorCode::invalid_value, "interrupted");
    return block < run_->last_position();
}

core::Result<void> DebugSession::go_to(size_t next_block) {
    if (next_block == at_) return {};
    const bool was_known = next_block <= run_->last_position();
    if (next_block > 0 && !knows(next_block - 1))
        return tl::unexpected(run_->state_at(next_block).error());
    run_->focus_on(next_block); // so that keyframes are stored near the position on the way
    // What has just been recorded need not be run again.
    if (next_block > at_ && (was_known || next_block == at_ + 1)) {
        run_->advance_to(*state_, at_, next_block);
    } else {
        FEELER_TRY(*state_, run_->state_at(next_block));
    }
    at_ = next_block;
    return {};
}

// --- walking -------------------------------------------------------------------------------------

Stop DebugSession::step(size_t blocks) {
    if (blocks == 0) return {};
    const size_t wanted = at_ + blocks;
    return SessionWalk(*this).forwards(
        {[=](size_t block, auto) { return block == wanted; }, false, StopReason::step});
}

Stop DebugSession::step_back(size_t blocks) {
    if (blocks == 0) return {};
    const size_t wanted = at_ - std::min(at_, blocks);
    if (at_ < blocks) return SessionWalk(*this).backwards({});
    return SessionWalk(*this).backwards(
        {[=](size_t block, auto) { return block == wanted; }, false, StopReason::step});
}

Stop DebugSession::next(size_t blocks) {
    if (blocks == 0) return {};
    SessionWalk walk(*this);
    const size_t depth = walk.depth(at_);
    size_t left = blocks;
    return walk.forwards(
        {[&](size_t block, auto) { return walk.depth(block) <= depth && --left == 0; }, false,
         StopReason::step});
}

Stop DebugSession::next_back(size_t blocks) {
    if (blocks == 0) return {};
    SessionWalk walk(*this);
    const size_t depth = walk.depth(at_);
    size_t left = blocks;
    return walk.backwards(
        {[&](size_t block, auto) { return walk.depth(block) <= depth && --left == 0; }, false,
         StopReason::step});
}

Stop DebugSession::finish() {
    SessionWalk walk(*this);
    const size_t depth = walk.depth(at_);
    return walk.forwards(
        {[&](size_t block, auto) { return walk.depth(block) < depth; }, false, StopReason::step});
}

Stop DebugSession::go_on() { return SessionWalk(*this).forwards({}); }

Stop DebugSession::reverse_resume() { return SessionWalk(*this).backwards({}); }

Stop DebugSession::until(const Condition& condition) {
    return SessionWalk(*this).forwards(
        {[&](size_t block, const gcode::InterpreterState* control) {
             return condition.holds({record(), block, control, &environment()});
         },
         condition.uses_control(), StopReason::found});
}

Stop DebugSession::next_finding() {
    SessionWalk walk(*this);
    return walk.forwards({[&](size_t block, auto) { return walk.offends(block); }});
}

Stop DebugSession::previous_finding() {
    SessionWalk walk(*this);
    return walk.backwards({[&](size_t block, auto) { return walk.offends(block); }});
}

Stop DebugSession::next_tool() {
    SessionWalk walk(*this);
    return walk.forwards({[&](size_t block, auto) { return walk.changes_tool(block); }});
}

Stop DebugSession::previous_tool() {
    SessionWalk walk(*this);
    return walk.backwards({[&](size_t block, auto) { return walk.changes_tool(block); }});
}

// --- where to stop -------------------------------------------------------------------------------

int DebugSession::add(Breakpoint breakpoint) {
    breakpoint.id = ++last_id_;
    breakpoints_.push_back(std::move(breakpoint));
    return last_id_;
}

core::Result<int> DebugSession::watch(std::string expression) {
    if (const auto known = value_of(expression, state_->control, environment()); !known)
        return tl::unexpected(known.error());
    watches_.push_back({++last_id_, std::move(expression)});
    return last_id_;
}

bool DebugSession::remove(int id) {
    const auto has_id = [id](const auto& stop_point) { return stop_point.id == id; };
    return std::erase_if(breakpoints_, has_id) + std::erase_if(watches_, has_id) > 0;
}

core::Result<uint32_t> DebugSession::line_with_block(uint32_t line) const {
    for (uint32_t at = line; at > 0 && at <= program().line_count(); ++at)
        if (gcode::has_a_block(program().line(at))) return at;
    return core::fail(core::ErrorCode::invalid_value,
                      fmt::format("no block in line {} or after it: the program has {} lines", line,
                                  program().line_count()));
}

core::Result<size_t> DebugSession::find_line(const std::string& line) {
    FEELER_TRY(const uint32_t number, gcode::line_meant(program(), environment().dialect, line));
    const auto is_there = [&](size_t block) {
        const CheckedBlock at = record().blocks[block];
        return at.line == number && at.file.empty();
    };
    for (size_t block = at_;; ++block) {
        FEELER_TRY(const bool is_run, reaches(block));
        if (!is_run) break;
        if (is_there(block)) return block;
    }
    for (size_t block = 0; block < at_; ++block)
        if (is_there(block)) return block;
    return core::fail(core::ErrorCode::invalid_value,
                      fmt::format("line {} is never executed", number));
}

// --- what if -------------------------------------------------------------------------------------

core::Result<void> DebugSession::change(const WhatIf& change) {
    if (const auto done = run_->change(at_, change); !done) return done;
    FEELER_TRY(*state_, run_->state_at(at_));
    return {};
}

core::Result<void> DebugSession::take_back() {
    FEELER_TRY(const size_t next_block, run_->take_back());
    FEELER_TRY(*state_, run_->state_at(next_block));
    at_ = next_block;
    return {};
}

} // namespace app

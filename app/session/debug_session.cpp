#include "app/session/debug_session.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "app/session/inspected_value.h"
#include "app/session/session_walk.h"
#include "gcode/program_text.h"
#include "gcode/restart.h"

namespace app {

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
    : run_(std::move(run)), place_(*run_->place_at(0)) {}

bool DebugSession::record_for(double seconds) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (run_->advance())
        if (Clock::now() >= end) return true;
    return false;
}

bool DebugSession::knows(size_t block) {
    while (run_->last_place() <= block && run_->advance()) {
    }
    return block < run_->last_place();
}

core::Result<bool> DebugSession::reaches(size_t block) {
    while (run_->last_place() <= block && run_->advance())
        if (is_interrupted && is_interrupted())
            return core::fail(core::ErrorCode::invalid_value, "interrupted");
    return block < run_->last_place();
}

core::Result<void> DebugSession::go_to(size_t place) {
    if (place == at_) return {};
    const bool was_known = place <= run_->last_place();
    if (place > 0 && !knows(place - 1)) return tl::unexpected(run_->place_at(place).error());
    run_->look_at(place); // the way there leaves keyframes near it
    // What was recorded just now need not be run again.
    if (place > at_ && (was_known || place == at_ + 1)) {
        run_->take_to(place_, at_, place);
    } else {
        FEELER_TRY(place_, run_->place_at(place));
    }
    at_ = place;
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

Stop DebugSession::go_on_back() { return SessionWalk(*this).backwards({}); }

Stop DebugSession::until(const Condition& condition) {
    return SessionWalk(*this).forwards(
        {[&](size_t block, const gcode::InterpreterState* control) {
             return condition.holds({record(), block, control, &environment()});
         },
         condition.asks_control(), StopReason::found});
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
    if (const auto known = value_of(expression, place_.control, environment()); !known)
        return tl::unexpected(known.error());
    watches_.push_back({++last_id_, std::move(expression)});
    return last_id_;
}

bool DebugSession::remove(int id) {
    const auto has_id = [id](const auto& kept) { return kept.id == id; };
    return std::erase_if(breakpoints_, has_id) + std::erase_if(watches_, has_id) > 0;
}

core::Result<uint32_t> DebugSession::line_with_block(uint32_t line) const {
    for (uint32_t at = line; at > 0 && at <= program().line_count(); ++at)
        if (gcode::has_a_block(program().line(at))) return at;
    return core::fail(
        core::ErrorCode::invalid_value,
        fmt::format("nothing is run in line {} or behind it: the program has {} lines", line,
                    program().line_count()));
}

core::Result<size_t> DebugSession::find_line(const std::string& line) {
    const gcode::Dialect& dialect = gcode::dialect(environment().dialect);
    FEELER_TRY(const uint32_t number, gcode::line_meant(program(), dialect, line));
    const auto is_there = [&](size_t block) {
        const CheckedBlock& at = record().blocks[block];
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
                      fmt::format("no block of line {} is run", number));
}

// --- what if -------------------------------------------------------------------------------------

core::Result<void> DebugSession::change(const WhatIf& change) {
    if (const auto done = run_->change(at_, change); !done) return done;
    FEELER_TRY(place_, run_->place_at(at_));
    return {};
}

core::Result<void> DebugSession::take_back() {
    FEELER_TRY(const size_t place, run_->take_back());
    FEELER_TRY(place_, run_->place_at(place));
    at_ = place;
    return {};
}

} // namespace app

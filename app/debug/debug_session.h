#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/debug/condition.h"
#include "app/debug/what_if.h"
#include "core/motion/event.h"

namespace gcode {
struct BlockResult;
struct Program;
} // namespace gcode

namespace app {

struct CheckJob;
struct PreparedCheck;
class RecordedRun;
struct RunState;
struct SetupFile;

/// Why a walk through a program ended.
enum class StopReason : uint8_t {
    step,        // it went as far as was asked
    breakpoint,  // `id`
    found,       // before the block that was looked for
    watch,       // a watched value changed, `id`
    end,         // of the program
    beginning,   // of the program, going back
    error,       // the control would stop here; the record says why
    interrupted, // by the one who asked
};

struct Stop {
    StopReason reason = StopReason::step;
    int id = 0;               // of the breakpoint or the watch
    std::string message = {}; // of a watch: old and new value
};

/// A value that walks stop at when it changes.
struct Watch {
    int id = 0; // counted together with breakpoints
    std::string expression;
    bool enabled = true;
    size_t hits = 0;
};

/// A program that can be walked through, both ways, and changed on the way.
///
/// The place is counted in blocks that have been run: at place p block p of the record is the next.
/// The record goes ahead of the place: what a block will do is known before it is run. One thread
/// at a time: whoever has a window gives it a thread of its own.
class DebugSession {
public:
    static constexpr size_t default_memory_budget = size_t(1) << 29; // bytes of keyframes

    /// Errors: as run_check.
    static core::Result<std::unique_ptr<DebugSession>>
    open(const CheckJob& job, size_t memory_budget = default_memory_budget);
    /// The same of a check that has been read, but not placed.
    static core::Result<std::unique_ptr<DebugSession>>
    open(const CheckJob& job, PreparedCheck check, size_t memory_budget = default_memory_budget);

    ~DebugSession();

    // --- the record ---

    /// What is known so far: blocks in order, findings as they were told. Complete when
    /// is_recorded: then it is what run_check gives.
    const CheckRun& record() const;
    bool is_recorded() const;
    /// Carries the record on for about so many seconds; whether there is more to come.
    bool record_for(double seconds);
    /// Carries the record on until block `block` is known; whether there is one that can be run.
    bool knows(size_t block);
    /// The same as a walk does it.
    ///
    /// Errors: it was interrupted.
    core::Result<bool> reaches(size_t block);
    /// How far the record is, 0..1, by lines.
    double recorded_share() const;

    const gcode::Program& program() const;
    const gcode::Environment& environment() const;
    /// The set-up that a block is run under; what-ifs change it on the way.
    const core::Setup& setup_at(size_t block) const;
    /// All but its `setup`, which is where setup_at has it.
    const SetupFile& setup_file() const;

    // --- the place ---

    /// Blocks that have been run.
    size_t at() const { return at_; }
    const RunState& state() const { return *state_; }
    const gcode::InterpreterState& control() const;
    /// The tool in the spindle; empty: none, or not known.
    std::optional<core::ToolNumber> tool() const;
    /// For each fixture of the set-up, whether it is mounted now.
    const std::vector<bool>& fixtures_there() const;
    size_t keyframe_count() const;
    size_t keyframe_memory() const; // bytes

    /// Shows the blocks that come next and what they are about to do, as far as `visit` wants.
    void visit_ahead(
        const std::function<bool(const gcode::BlockResult&, std::span<const core::Event>)>& visit);

    /// Goes to a place, recording as far as needed.
    ///
    /// Errors: the program does not go that far. The place has not changed then.
    /// Cost:   some 10 ms near where one has been lately, under a second anywhere the record has
    ///         been.
    core::Result<void> go_to(size_t place);

    // --- walking: each says why it ended ---

    Stop step(size_t blocks = 1);
    Stop step_back(size_t blocks = 1);
    /// As step, but past the blocks of subprograms that are called, if no breakpoint is there.
    Stop next(size_t blocks = 1);
    Stop next_back(size_t blocks = 1);
    /// To the first block behind the subprogram that the place is in; in the main program, on.
    Stop finish();
    /// To the next breakpoint, watch, or the end.
    Stop go_on();
    Stop go_on_back();
    /// To the next block of which a question is true; breakpoints and watches stop it, too.
    Stop until(const Condition& condition);
    /// To the next or previous block with a finding of severity error, or of which it is not proven
    /// that it keeps its allowances.
    Stop next_finding();
    Stop previous_finding();
    /// To the next or previous block that changes the tool.
    Stop next_tool();
    Stop previous_tool();

    /// Asked now and then on long walks; true ends them where they are.
    std::function<bool()> is_interrupted;

    // --- where to stop ---

    /// Gives it an id, from 1 on and never used twice, and keeps it. The id.
    int add(Breakpoint breakpoint);
    /// Errors: an expression that value_of does not know.
    core::Result<int> watch(std::string expression);
    /// Whether there was one, breakpoint or watch.
    bool remove(int id);
    std::vector<Breakpoint>& breakpoints() { return breakpoints_; }
    std::vector<Watch>& watches() { return watches_; }

    /// A line of the main program, or the next one behind it, that holds more than comments: where
    /// a breakpoint on it can stop.
    ///
    /// Errors: there is none.
    core::Result<uint32_t> line_with_block(uint32_t line) const;

    /// The first place before a block of a line of the main program, "120", or of a block number,
    /// "N210": from the place on, else from the beginning.
    ///
    /// Errors: there is no such line; no block of it is run.
    core::Result<size_t> find_line(const std::string& line);

    // --- what if ---

    /// Changes something from the place on. What was recorded before stays; what comes, and what
    /// was changed there, goes, and is recorded anew.
    ///
    /// Errors: as apply. Nothing has changed then.
    core::Result<void> change(const WhatIf& change);
    /// Takes the last change back and goes to where it was made.
    ///
    /// Errors: nothing has been changed.
    core::Result<void> take_back();
    const std::vector<MadeChange>& changes() const;

private:
    friend class SessionWalk;

    explicit DebugSession(std::unique_ptr<RecordedRun> run);

    std::unique_ptr<RecordedRun> run_;
    std::unique_ptr<RunState> state_;
    size_t at_ = 0;
    int last_id_ = 0;
    std::vector<Breakpoint> breakpoints_ = {};
    std::vector<Watch> watches_ = {};
};

} // namespace app

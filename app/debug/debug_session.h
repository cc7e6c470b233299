#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/check/block_events.h"
#include "app/debug/condition.h"
#include "app/debug/what_if.h"

namespace core {
struct CutModel;
} // namespace core
namespace gcode {
struct Program;
} // namespace gcode

namespace app {

struct CheckJob;
struct PreparedCheck;
class RecordedRun;
struct RunState;
struct SetupFile;

/// An expression; a walk stops when its value changes.
struct Watch {
    int id = 0; // from the same sequence as breakpoints
    std::string expression;
    bool enabled = true;
    size_t hits = 0;
};

/// A program that can be stepped forwards and backwards, and changed on the way.
///
/// The position is the number of blocks already run: at position p, block p of the record is next.
/// The record runs ahead of the position, so the result of a block is known before the session
/// steps over it. Not thread-safe; the window uses it from a single separate thread.
class DebugSession {
public:
    static constexpr size_t default_memory_budget = size_t(1) << 29; // bytes of keyframes

    /// Errors: as run_check.
    static core::Result<std::unique_ptr<DebugSession>>
    open(const CheckJob& job, size_t memory_budget = default_memory_budget);
    /// The same for a check that read_check has read but place_check has not placed.
    static core::Result<std::unique_ptr<DebugSession>>
    open(const CheckJob& job, PreparedCheck check, size_t memory_budget = default_memory_budget);

    ~DebugSession();

    // --- the record ---

    /// The blocks run so far, in order, and their findings as they were reported. When
    /// is_recorded, it equals the result of run_check.
    const CheckRun& record() const;
    bool is_recorded() const;
    /// Extends the record for about this many seconds. False once it is complete.
    bool record_for(double seconds);
    /// Extends the record up to a block. False if the run ends before it.
    bool knows(size_t block);
    /// As knows, but stops when is_interrupted returns true.
    ///
    /// Errors: interrupted.
    core::Result<bool> reaches(size_t block);
    /// Progress of the record by program lines, 0..1.
    double recorded_fraction() const;

    const gcode::Program& program() const;
    const gcode::Environment& environment() const;
    /// The set-up in effect for a block, with the what-ifs made before it.
    const core::Setup& setup_at(size_t block) const;
    /// The set-up file. For the set-up itself use setup_at.
    const SetupFile& setup_file() const;

    // --- the position ---

    /// The number of blocks already run.
    size_t at() const { return at_; }
    const RunState& state() const { return *state_; }
    const gcode::InterpreterState& control() const;
    /// The tool in the spindle; empty: none, or unknown.
    std::optional<core::ToolNumber> tool() const;
    /// The position of the machine; empty for axes where it is unknown.
    const core::AxisPosition& position() const;
    /// The current stock.
    const core::CutModel& stock() const;
    /// For each fixture of the set-up, whether it is mounted now.
    const std::vector<bool>& mounted_fixtures() const;
    size_t keyframe_count() const;
    size_t keyframe_memory() const; // bytes

    /// Passes the next blocks and their events to `visit`, without running them, until it returns
    /// false.
    void visit_ahead(const BlockVisit& visit);

    /// Goes to a position; extends the record if needed.
    ///
    /// Errors: the program has fewer blocks; then the position does not change.
    /// Cost:   some 10 ms near recent positions, under a second anywhere in the record.
    core::Result<void> go_to(size_t next_block);

    // --- walking: each returns why it stopped ---

    Stop step(size_t blocks = 1);
    Stop step_back(size_t blocks = 1);
    /// As step, but skips the blocks of called subprograms, unless a breakpoint stops there.
    Stop next(size_t blocks = 1);
    Stop next_back(size_t blocks = 1);
    /// Goes to the first block after the current subprogram; in the main program, to the end.
    Stop finish();
    /// Goes to the next breakpoint, watch, or the end.
    Stop go_on();
    Stop reverse_resume();
    /// Goes to the next block that meets the condition, or to a breakpoint or watch before it.
    Stop until(const Condition& condition);
    /// Goes to the next or previous block that has a finding of severity error or is not proven
    /// clear.
    Stop next_finding();
    Stop previous_finding();
    /// Goes to the next or previous block that changes the tool.
    Stop next_tool();
    Stop previous_tool();

    /// Called at intervals during long walks; true stops the walk.
    std::function<bool()> is_interrupted;

    // --- where to stop ---

    /// Adds a breakpoint and returns its id. Ids start at 1 and are never reused.
    int add(Breakpoint breakpoint);
    /// Adds a watch and returns its id.
    ///
    /// Errors: those of value_of for the expression.
    core::Result<int> watch(std::string expression);
    /// Removes a breakpoint or watch. False if none has this id.
    bool remove(int id);
    std::vector<Breakpoint>& breakpoints() { return breakpoints_; }
    std::vector<Watch>& watches() { return watches_; }

    /// The first line of the main program from `line` on that contains a block, so that a
    /// breakpoint can stop there.
    ///
    /// Errors: no such line.
    core::Result<uint32_t> line_with_block(uint32_t line) const;

    /// The first position before a block of a line of the main program ("120") or of a block number
    /// ("N210"), searched from the current position on, then from the beginning.
    ///
    /// Errors: no such line; the line is never executed.
    core::Result<size_t> find_line(const std::string& line);

    // --- what if ---

    /// Applies a change from the current position on. The record after it, with later changes, is
    /// dropped and recorded again.
    ///
    /// Errors: as apply; then nothing changes.
    core::Result<void> change(const WhatIf& change);
    /// Undoes the last change and goes to the position where it was made.
    ///
    /// Errors: there is no change to undo.
    core::Result<void> take_back();
    const std::vector<AppliedChange>& changes() const;

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

#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/check/block_events.h"
#include "app/debug/what_if.h"
#include "core/sim/finding.h"

namespace gcode {
class ProgramLibrary;
} // namespace gcode

namespace app {

class BlockRunner;
struct CheckJob;
struct CheckProgress;
struct CheckRun;
class Keyframes;
struct PreparedCheck;
class ProgramRunner;

/// A check that runs block by block. It can return to any earlier position, and set-up or state can
/// be changed on the way.
///
/// A position is the number of blocks already run: at position p, block p of the record is next.
class RecordedRun {
public:
    /// Starts a check that read_check has read but place_check has not placed. The job's
    /// `after_block` can end it, as in run_check. `memory_budget`: bytes for keyframes.
    ///
    /// Errors: as run_check.
    static core::Result<std::unique_ptr<RecordedRun>> open(const CheckJob& job, PreparedCheck check,
                                                           size_t memory_budget);
    ~RecordedRun();

    /// The blocks run so far, in order, and their findings as they were reported. When complete, it
    /// equals the result of run_check.
    const CheckRun& record() const;
    bool is_complete() const { return is_complete_; }
    /// The last position of the record.
    size_t last_position() const { return marks_.size() - 1; }
    /// Progress by program lines, 0..1.
    double fraction() const;

    /// Runs the next block. False at the end of the program.
    bool advance();

    const PreparedCheck& check() const { return *check_; }
    /// Ends the work of other threads with the program for now; advance() may start it again.
    void work_alone() const;
    /// The main program. Other threads may read it during advance(), so ask for it again after
    /// that.
    const gcode::Program& program() const;
    /// The subprograms that all run states refer to. As for the program, ask again.
    gcode::ProgramLibrary& library() const;
    /// The set-up in effect for a block.
    const core::Setup& setup_at(size_t block) const;

    /// A copy of the state at a position.
    ///
    /// Errors: the program has fewer blocks.
    /// Cost:   as advance_to, from the nearest keyframe.
    core::Result<RunState> state_at(size_t position);
    /// Moves a copy of the state at position `from` on to a later position of the record.
    ///
    /// Cost: runs the blocks after the nearest keyframe before `position` again.
    void advance_to(RunState& state, size_t from, size_t position);

    /// As BlockRunner::visit_ahead, from a copy of the state at a position.
    void visit_ahead(size_t position, const RunState& state, const BlockVisit& visit);

    /// Keeps keyframes densest near this position.
    void focus_on(size_t position);
    /// The position of the last keyframe at or before a position.
    size_t keyframe_before(size_t position) const;
    // How much the keyframes take, to verify that they stay within the budget.
    size_t keyframe_count() const;
    size_t keyframe_memory() const; // bytes

    /// Changes something from a position on, and drops everything recorded after it, later changes
    /// included.
    ///
    /// Errors: as apply; the program has fewer blocks. Then nothing changes.
    core::Result<void> change(size_t position, const WhatIf& change);
    /// Undoes the last change. Returns the position where it was made.
    ///
    /// Errors: invalid_value if there is none.
    core::Result<size_t> take_back();
    const std::vector<AppliedChange>& changes() const { return changes_; }

private:
    /// The size of the record at a position.
    struct Mark {
        double seconds = 0.0; // of work up to the position
        size_t findings = 0;
    };
    /// Findings and assumptions without those added at the end of the run.
    struct Reported {
        std::vector<core::Finding> findings;
        std::vector<std::string> assumptions;
    };

    RecordedRun(PreparedCheck check, size_t memory_budget);
    void finish();
    /// A copy of the state at a recorded position, rebuilt from the nearest keyframe, with the
    /// changes made there.
    RunState replayed(size_t position);
    /// Drops the keyframes from a position on, and the changes after it.
    void forget_from(size_t position);
    /// Makes the record again up to a position, to continue from there.
    void record_again_from(size_t position);
    /// Applies the changes made at a position to a copy of its state.
    void change_at(size_t position, RunState& state);
    /// The position from which to run blocks again to rebuild the record up to `position`.
    size_t restart_position(size_t position);

    std::unique_ptr<PreparedCheck> check_;
    bool needs_surface_ = false;
    std::function<bool(const CheckProgress&)> after_block_ = {};
    std::unique_ptr<ProgramRunner> runner_;
    std::unique_ptr<BlockRunner> replayer_;
    std::unique_ptr<Keyframes> keyframes_;
    std::vector<Mark> marks_ = std::vector<Mark>(1); // by position
    std::vector<AppliedChange> changes_ = {};
    std::vector<std::unique_ptr<core::Setup>> setups_ = {}; // after each change
    Reported reported_ = {};
    bool is_complete_ = false;
};

} // namespace app

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/check/block_events.h"
#include "app/check/check_run.h"
#include "core/sim/run/block_clock.h"
#include "gcode/exec/interpreter.h"

namespace gcode {
struct Lowering;
}

namespace app {

class DogLegTrial;
class RunAhead;
struct PreparedCheck;
struct ReadBlock;
struct RunState;

/// The finding for a warning of the interpreter, with its severity in the set-up.
core::Finding finding_of(const core::Setup& setup, const gcode::Warning& warning);

/// The finding for an alarm of the control; empty if no rule names it.
std::optional<core::Finding> alarm_finding(const core::Setup& setup, const core::Error& error);

/// What a block does if its rapids are dog-legs, where that is worse than straight.
struct DogLegResult {
    core::Verdict verdict = core::Verdict::clear;
    std::vector<core::Finding> errors; // that the block lacks if its rapids are straight
};

/// The result of one block.
struct BlockStep {
    CheckedBlock checked;
    std::vector<core::Finding> findings;
    std::vector<core::BlockTime> timed;           // blocks whose start and duration are now final
    std::optional<DogLegResult> as_dog_legs = {}; // if asked for, and worse
};

/// Runs the blocks of a program one at a time. All state of the run is in the RunState. The check
/// must outlive the runner.
class BlockRunner {
public:
    explicit BlockRunner(const PreparedCheck& check);
    ~BlockRunner();

    // Called after the control has read a block and before it moves, with the state before
    // the block.
    std::function<void(const gcode::BlockCommands&, const RunState&)> before_block;
    // Called after the control has read a block, or failed to, with the state before it and the
    // control's state after it.
    std::function<void(const RunState&, const gcode::InterpreterState&)> after_reading;
    BlockJudge judge;              // empty: the distance core measures clearances
    bool follows_dog_legs = false; // also runs rapids as dog-legs

    const core::Setup& setup() const { return *setup_; }
    /// Uses another set-up from the next block on. It must outlive the runner.
    void use(const core::Setup& setup);

    /// Lets step() use other threads, too, if it runs many blocks one after the other on the same
    /// state, which nobody else changes. Between two calls of step(), other threads may then read
    /// the program's library: call work_alone() before using it.
    /// They start after `first` blocks, or later for a large stock: to start them takes as long as
    /// some hundred blocks. At most eight are used.
    void use_threads(unsigned threads, size_t first = 256);
    /// Ends the work of other threads for now.
    void work_alone();
    /// Number of blocks that other threads have read and cut.
    size_t foreseen_blocks() const { return foreseen_; }

    /// Runs the next block; empty at the end of the program.
    ///
    /// Result: bit-identical for the same state, whatever the number of threads.
    /// Errors: alarms of the control, and blocks that the machine cannot run. The state is then
    ///         unchanged.
    core::Result<std::optional<BlockStep>> step(RunState& state);

    /// Reads the following blocks without running them, until `visit` returns false, the program
    /// ends, or it has an error.
    void visit_ahead(gcode::InterpreterState control, gcode::Lowering lowering,
                     const BlockVisit& visit);

private:
    /// The next block if another thread has read it; null if it must be read now.
    ReadBlock* read_ahead(RunState& state);
    /// Ends the work of other threads, except that the current block is still needed.
    void stop_reading_ahead();
    core::Result<std::optional<BlockStep>> run_next(RunState& state);

    std::optional<core::Error> refusal(const gcode::BlockCommands& block,
                                       const gcode::Lowering& lowering) const;
    /// How far the motions of a block are known. Reports the first block in which an axis that no
    /// set-up describes is away from 0.
    core::PathCertainty certainty(const gcode::BlockCommands& block,
                                  std::span<const core::Event> events, RunState& state,
                                  std::vector<core::Finding>& findings) const;
    /// Adds the findings for the interpreter's warnings.
    void add_warnings(const gcode::BlockCommands& block, const RunState& state,
                      std::vector<core::Finding>& findings) const;

    const PreparedCheck& check_;
    const core::Setup* setup_;
    std::unique_ptr<const DogLegTrial> dog_legs_; // under this set-up, once it is needed
    gcode::Interpreter interpreter_;
    gcode::InterpreterState next_; // after the block; a member to avoid an allocation per block

    unsigned threads_ = 1;
    std::unique_ptr<RunAhead> ahead_; // of the run with the state `ahead_of_`
    const RunState* ahead_of_ = nullptr;
    bool is_ahead_over_ = false;
    size_t alone_ = 0;  // blocks since the last such run
    size_t served_ = 0; // blocks of this one
    size_t foreseen_ = 0;
    size_t first_pause_ = 0, pause_ = 0; // blocks before the next one
};

} // namespace app

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/check/check_run.h"
#include "app/check/run_state.h"

namespace gcode {
struct BlockCommands;
}

namespace app {

class CorrectedRun;
struct CheckProgress;
struct PreparedCheck;

/// Adds the name of a file to an error that has none.
core::Error named(core::Error error, const std::string& file);

/// The finding for a warning of the interpreter, with its severity in the set-up.
core::Finding finding_of(const core::Setup& setup, const gcode::Warning& warning);

/// Receives a block and its events. Returns false to see no more blocks.
using BlockVisit = std::function<bool(const gcode::BlockCommands&, std::span<const core::Event>)>;

/// The events of the first block that `show` passes to its visitor; empty if there is none.
std::optional<std::vector<core::Event>>
first_events(const std::function<void(const BlockVisit&)>& show);

/// The result of one block.
struct BlockStep {
    CheckedBlock checked;
    std::vector<core::Finding> findings;
    std::vector<core::BlockTime> timed; // blocks whose start and duration are now final
};

/// Runs the blocks of a program one at a time. All state of the run is in the RunState. The check
/// must outlive the runner.
class BlockRunner {
public:
    explicit BlockRunner(const PreparedCheck& check);

    // Called after the control has read a block and before it moves, with the state before
    // the block.
    std::function<void(const gcode::BlockCommands&, const RunState&)> before_block;
    // Judges a block in place of the distance core; empty: the distance core measures clearances.
    std::function<core::Result<core::Judgement>(std::span<const core::Event>,
                                                const core::SimulatorState&)>
        judge;

    const core::Setup& setup() const { return *setup_; }
    /// Uses another set-up from the next block on. It must outlive the runner.
    void use(const core::Setup& setup) { setup_ = &setup; }

    /// Runs the next block; empty at the end of the program.
    ///
    /// Result: bit-identical for the same state.
    /// Errors: alarms of the control, and blocks that the machine cannot run. The state is then
    ///         unchanged.
    core::Result<std::optional<BlockStep>> step(RunState& state);

    /// Reads the following blocks without running them, until `visit` returns false, the program
    /// ends, or it has an error.
    void visit_ahead(gcode::InterpreterState control, gcode::Lowering lowering,
                     const BlockVisit& visit);

private:
    std::optional<core::Error> refusal(const gcode::BlockCommands& block,
                                       const gcode::Lowering& lowering) const;
    /// Adds the findings for the interpreter's warnings.
    void add_warnings(const gcode::BlockCommands& block, const RunState& state,
                      std::vector<core::Finding>& findings) const;

    const PreparedCheck& check_;
    const core::Setup* setup_;
    gcode::Interpreter interpreter_;
    gcode::InterpreterState next_; // after the block; a member to avoid an allocation per block
};

/// Runs a program against a complete set-up and records the results in the check's run. The check
/// must outlive the runner.
class ProgramRunner {
public:
    /// Takes the simulator's state out of the check.
    explicit ProgramRunner(PreparedCheck& check);
    ~ProgramRunner();
    // Members refer to each other.
    ProgramRunner(const ProgramRunner&) = delete;
    ProgramRunner& operator=(const ProgramRunner&) = delete;

    std::function<bool(const CheckProgress&)> after_block; // false: stop after this block
    // Called for each block, in order, when its start and duration are final.
    std::function<void(const core::BlockTime&)> on_timed;

    /// Judges blocks by `judge` in place of the distance core (BlockRunner::judge). Findings caused
    /// by a wrong tool length are then reported for each block.
    void let_judge(decltype(BlockRunner::judge) judge);

    /// Starts in the middle of the program, at a line ("120") or block number ("N210"), with the
    /// control in its power-on state.
    ///
    /// Errors: no such line or block, and those of gcode::restart_at.
    core::Result<void> start_at(const std::string& line);

    /// Runs the next block. False at the end of the program or on an error, which is then in the
    /// run. Then also adds the findings about the whole program.
    bool advance();

    /// Ends the run after the last block as stopped by the user. There must be a block.
    void stop_here();

    /// Runs the program to its end or to its first error.
    void run_to_end();

    const RunState& state() const { return state_; }
    CheckProgress progress() const;

    /// Uses another set-up from the next block on. It must outlive the runner.
    void use(const core::Setup& setup) { runner_.use(setup); }
    /// The state from which the run continues.
    RunState& mutable_state() { return state_; }

    /// Returns to an earlier state of this run: drops the blocks from there on; advance() runs them
    /// again. The first `findings` findings of the run must still be in their original order, and
    /// the state must have no open length mismatch.
    void go_back(const RunState& state, size_t blocks, size_t findings);

    /// Blocks in which the control used a wrong tool length.
    std::vector<LengthMismatch> length_mismatches() const;

private:
    /// Runs a block of a length mismatch again with the true length.
    void follow_correction(const gcode::BlockCommands& block, const RunState& before);
    void end_correction();
    /// Ends the run at an error. An alarm of the control becomes a block and, if a rule names it, a
    /// finding.
    void stop(core::Error error);
    /// Stores final times in the blocks.
    void enter(const std::vector<core::BlockTime>& timed);
    /// Adds findings about the whole program.
    void end();
    /// Compares the feeds of the program with the size and position of the stock.
    void compare_with_stock();
    /// Makes the fixture moves of the lines before the start line.
    void make_moves_before(uint32_t line);
    /// Reports fixture moves of the set-up that no block has triggered.
    void report_missing_moves();

    const PreparedCheck& check_;
    CheckRun& run_;
    BlockRunner runner_;
    RunState state_;
    uint32_t last_line_ = 0; // of the main program
    std::unique_ptr<CorrectedRun> correction_;
    LengthMismatch corrected_ = {};                // the mismatch that `correction_` runs
    std::vector<LengthMismatch> corrections_ = {}; // results, by the first block of the mismatch
    size_t first_to_time_ = 0;                     // blocks before it have their final times
};

} // namespace app

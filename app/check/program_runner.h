#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/check/block_events.h"
#include "app/check/length_mismatch.h"
#include "core/base/result.h"

namespace core {
struct BlockTime;
} // namespace core

namespace app {

class BlockRunner;
class OtherReadings;
struct CheckInput;
struct CheckProgress;
struct CheckRecord;
class CorrectedRun;
struct PreparedCheck;
struct RunState;

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

    /// Uses up to so many threads, this one included. Until the run has ended, nobody else may
    /// change its state or use the program's library. They start after `first` blocks.
    void use_threads(unsigned threads, size_t first = 256);
    /// Ends the work of other threads for now.
    void work_alone();
    /// Number of blocks that other threads have read and cut.
    size_t foreseen_blocks() const;

    /// Judges blocks by `judge` in place of the distance core. Findings caused by a wrong tool
    /// length are then reported for each block.
    void use_judge(BlockJudge judge);

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

    /// Completes the report of the run, which has ended.
    void conclude(bool needs_surface);

    const RunState& state() const { return *state_; }
    /// The part of the simulator in the state.
    const core::SimulatorState& machine() const;
    CheckProgress progress() const;
    /// The next block, without running it; empty if there is none.
    std::optional<NextBlock> next_block();

    /// Uses another set-up from the next block on. It must outlive the runner.
    void use(const core::Setup& setup);
    /// The state from which the run continues.
    RunState& mutable_state();

    /// Prepares for going back after the end: keeps the states from which other readings branch
    /// off.
    void keep_readings();

    /// Returns to an earlier state of this run: drops the blocks from there on; advance() runs them
    /// again. The first `findings` findings of the run must still be in their original order, and
    /// the state must have no open length mismatch.
    void go_back(const RunState& state, size_t blocks, size_t findings);

private:
    /// Blocks in which the control used a wrong tool length.
    std::vector<LengthMismatch> length_mismatches() const;
    /// Runs a block of a length mismatch again with the true length.
    void follow_correction(const gcode::BlockCommands& block, const RunState& before);
    void end_correction();
    /// Ends the run at an error. An alarm of the control becomes a block and, if a rule names it, a
    /// finding.
    void stop(core::Error error);
    /// Adds the block of an error that ends the program, with a finding.
    void add_last_block(const core::Error& error, core::Finding finding);
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

    PreparedCheck& check_;
    const CheckInput& input_;
    CheckRecord& record_;
    std::unique_ptr<BlockRunner> runner_;
    std::unique_ptr<OtherReadings> readings_;
    std::unique_ptr<RunState> state_;
    uint32_t last_line_ = 0;  // of the main program
    bool is_partial_ = false; // started in the middle
    std::unique_ptr<CorrectedRun> correction_;
    std::vector<LengthMismatch> corrections_; // results, by the first block of the mismatch
    size_t first_to_time_ = 0;                // blocks before it have their final times
};

} // namespace app

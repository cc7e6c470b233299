#pragma once

#include "app/session/block_runner.h"
#include "app/session/prepared_check.h"

namespace app {

/// Carries a program out block by block against a set-up that is complete, and writes what comes of
/// it into the run. Refers to what it was given.
class ProgramRunner {
public:
    /// Takes the machine out of the check.
    explicit ProgramRunner(PreparedCheck& check);
    // Its parts refer to one another.
    ProgramRunner(const ProgramRunner&) = delete;
    ProgramRunner& operator=(const ProgramRunner&) = delete;

    std::function<bool(const CheckProgress&)> after_block; // false: stop there
    // Told of blocks in order, when their places in time have become known.
    std::function<void(const core::BlockTime&)> on_timed;

    /// Lets somebody else than the distance core say what blocks keep (BlockRunner::judge). What
    /// comes of wrong tool lengths is then not gathered, but told block by block.
    void let_judge(decltype(BlockRunner::judge) judge);

    /// Begins in the middle of the program, at a line or "N210", as a control does that was just
    /// switched on.
    ///
    /// Errors: no such line or block, and those of gcode::restart_at.
    core::Result<void> start_at(const std::string& line);

    /// Runs the next block. False: there was none, or an error, which is then in the run; what can
    /// only be told behind the last block is in the run, too.
    bool advance();

    /// Ends the run behind the last block, as one that somebody stopped. There must be a block.
    void stop_here();

    /// Runs the program to its end or to its first error.
    void to_the_end();

    const RunPlace& place() const { return place_; }
    CheckProgress progress() const;

    /// From the next block on. The set-up must outlive the runner.
    void use(const core::Setup& setup) { runner_.use(setup); }
    /// Where the run goes on.
    RunPlace& place_to_change() { return place_; }

    /// Goes back to a place from which the run was not long ago: what the run holds of the blocks
    /// from there on is dropped, and made again by advance(). The run must hold the first
    /// `findings` of its findings as they were told, and no block of a length doubt may be open at
    /// the place.
    void go_back(const RunPlace& place, size_t blocks, size_t findings);

    /// Where the control counted with a wrong length.
    std::vector<LengthDoubt> length_doubts() const;

private:
    /// Runs the block of a length doubt with the right length, beside the program.
    void follow_cure(const gcode::BlockResult& block, const ProgramPlace& before);
    void end_cure();
    /// A control stops with an alarm where this error is: a block of its own, and a finding if a
    /// rule has a name for it.
    void stop(core::Error error);
    /// The times of blocks whose place in time has become known.
    void enter(const std::vector<core::BlockTime>& timed);
    /// What can only be told behind the last block.
    void end();
    /// What the program as a whole does, against the size and the place of the stock.
    void hold_against_stock();
    /// Fixture moves of the lines before a restart: they have been made.
    void make_moves_before(uint32_t line);
    /// Fixture moves that the set-up asks for and no block has made.
    void tell_of_moves_not_made();

    const PreparedCheck& check_;
    CheckRun& run_;
    BlockRunner runner_;
    RunPlace place_;
    uint32_t last_line_ = 0; // of the main program
    std::unique_ptr<CuredRun> cured_ = {};
    std::vector<LengthDoubt> cures_ = {}; // what came of it, by the first blocks of doubts
    LengthDoubt followed_ = {};           // the doubt that it is about
    size_t first_to_time_ = 0;            // blocks before it have their place in time
};

} // namespace app

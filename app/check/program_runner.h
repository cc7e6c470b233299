#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/check/check_run.h"
#include "app/check/length_mismatch.h"
#include "app/check/offset_watch.h"
#include "app/check/run_state.h"

namespace app {

struct CheckProgress;

/// What a program stands on between two blocks.
struct BlockContext {
    const gcode::InterpreterState& at;
    const gcode::Lowering& lowering;
    const core::SimulatorState& state;
    const OffsetWatch& offsets;
    const LengthWatch& lengths;
};

class CorrectedRun;
struct PreparedCheck;

/// The error with the name of a file, unless it has one.
core::Error named(core::Error error, const std::string& file);

/// The finding that a warning of the interpreter makes, under the severities of the set-up.
core::Finding remark(const core::Setup& setup, const gcode::Warning& warning);

/// Looks at a block and what it does; whether it wants to see the next one.
using BlockVisit = std::function<bool(const gcode::BlockResult&, std::span<const core::Event>)>;

/// The events of the first block that a way ahead shows; empty if it shows none. `show` is given
/// who looks.
std::optional<std::vector<core::Event>>
first_events(const std::function<void(const BlockVisit&)>& show);

/// What carrying out one block gave.
struct BlockStep {
    CheckedBlock checked;
    std::vector<core::Finding> findings;
    std::vector<core::BlockTime> timed; // blocks whose place in time has become known
};

/// Carries out the blocks of a program one at a time. It keeps nothing of a run: all of that is in
/// the place. Refers to the check.
class BlockRunner {
public:
    explicit BlockRunner(const PreparedCheck& check);

    // Told of a block before it is run, when the control has read it and nothing has moved.
    std::function<void(const gcode::BlockResult&, const BlockContext&)> before_block;
    // Says of a block what the distance core would; empty: that is measured.
    std::function<core::Result<core::Judgement>(std::span<const core::Event>,
                                                const core::SimulatorState&)>
        judge;

    const core::Setup& setup() const { return *setup_; }
    /// From the next block on. The set-up must outlive the runner.
    void use(const core::Setup& setup) { setup_ = &setup; }

    /// Carries out the next block; empty at the end of the program.
    ///
    /// Result: the same, to the last bit, from the same place.
    /// Errors: what the control would stop at, and blocks that the machine cannot carry out. The
    ///         place has not changed then.
    core::Result<std::optional<BlockStep>> step(RunState& place);

    /// Shows the blocks that come after a place of the control and what they are about to do,
    /// without carrying them out, as long as `visit` wants more; up to the end or the first error.
    void visit_ahead(gcode::InterpreterState control, gcode::Lowering lowering,
                     const BlockVisit& visit);

private:
    std::optional<core::Error> refusal(const gcode::BlockResult& block,
                                       const gcode::Lowering& lowering) const;
    /// What the interpreter remarks of a block.
    void remark_on(const gcode::BlockResult& block, const RunState& place,
                   std::vector<core::Finding>& findings) const;

    const PreparedCheck& check_;
    const core::Setup* setup_;
    gcode::Interpreter interpreter_;
    gcode::InterpreterState before_; // avoids an allocation for each block
};

/// Carries a program out block by block against a set-up that is complete, and writes what comes of
/// it into the run. Refers to what it was given.
class ProgramRunner {
public:
    /// Takes the machine out of the check.
    explicit ProgramRunner(PreparedCheck& check);
    ~ProgramRunner();
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

    const RunState& place() const { return place_; }
    CheckProgress progress() const;

    /// From the next block on. The set-up must outlive the runner.
    void use(const core::Setup& setup) { runner_.use(setup); }
    /// Where the run goes on.
    RunState& place_to_change() { return place_; }

    /// Goes back to a place from which the run was not long ago: what the run holds of the blocks
    /// from there on is dropped, and made again by advance(). The run must hold the first
    /// `findings` of its findings as they were told, and no block of a length doubt may be open at
    /// the place.
    void go_back(const RunState& place, size_t blocks, size_t findings);

    /// Where the control counted with a wrong length.
    std::vector<LengthMismatch> length_doubts() const;

private:
    /// Runs the block of a length doubt with the right length, beside the program.
    void follow_cure(const gcode::BlockResult& block, const BlockContext& before);
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
    RunState place_;
    uint32_t last_line_ = 0; // of the main program
    std::unique_ptr<CorrectedRun> cured_;
    std::vector<LengthMismatch> cures_ = {}; // what came of it, by the first blocks of doubts
    LengthMismatch followed_ = {};           // the doubt that it is about
    size_t first_to_time_ = 0;               // blocks before it have their place in time
};

} // namespace app

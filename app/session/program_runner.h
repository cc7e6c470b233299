#pragma once

#include "app/session/check_run.h"
#include "app/session/cured_run.h"
#include "app/session/length_doubt.h"
#include "app/session/offset_watch.h"
#include "app/session/units_watch.h"
#include "core/sim/block_clock.h"
#include "gcode/lowering.h"

namespace app {

/// The error with the name of a file, unless it has one.
core::Error named(core::Error error, const std::string& file);

/// Carries a program out block by block against a set-up that is complete. Refers to what it was
/// given.
class ProgramRunner {
public:
    ProgramRunner(const gcode::Program& program, const gcode::Environment& environment,
                  CheckRun& run)
        : program_(program), environment_(environment), run_(run) {}

    std::function<bool(const CheckProgress&)> after_block; // false: stop there
    bool speed_by_hand = false;                            // whatever the program says of it
    std::set<int> offsets_stated; // work offsets that the set-up states, 0 is G54
    bool stock_is_stated = true;  // false: it was made from the program's own cuts

    /// Begins in the middle of the program, at a line or "N210", as a control does that was just
    /// switched on.
    ///
    /// Errors: no such line or block, and those of gcode::restart_at.
    core::Result<void> start_at(const std::string& line);

    /// Runs the program to its end or to its first error, which is then in the run.
    void to_the_end(core::SimulatorState& state);

    /// Where the control counted with a wrong length.
    const std::vector<LengthDoubt>& length_doubts() const { return lengths_.doubts; }

private:
    /// What the interpreter remarks of a block that was run.
    void remark_on(const gcode::BlockResult& block);
    void run_blocks(core::SimulatorState& state);
    /// Runs a block, or says why it cannot be.
    std::optional<core::Error> block(const gcode::BlockResult& block, core::SimulatorState& state);
    /// Runs the block of a length doubt with the right length, beside the program.
    void follow_cure(const gcode::BlockResult& block, const ProgramPlace& before);
    void end_cure();
    std::optional<core::Error> refusal(const gcode::BlockResult& block) const;
    /// A control stops with an alarm where this error is: a block of its own, and a finding if a
    /// rule has a name for it.
    void stop(core::Error error);
    /// The times of blocks whose place in time has become known.
    void enter(const std::vector<core::BlockTime>& timed);
    /// What the program as a whole does, against the size and the place of the stock.
    void hold_against_stock(const core::SimulatorState& state);
    /// Fixture moves of the lines before a restart: they have been made.
    void make_moves_before(uint32_t line);
    /// Fixture moves that the set-up asks for and no block has made.
    void tell_of_moves_not_made();
    CheckProgress progress(const gcode::BlockResult& block);

    const gcode::Program& program_;
    const gcode::Environment& environment_;
    CheckRun& run_;
    gcode::ProgramLibrary library_{program_, gcode::dialect(environment_.dialect),
                                   environment_.search_path};
    gcode::Interpreter interpreter_{library_, environment_};
    gcode::InterpreterState place_ = gcode::initial_state(environment_);
    gcode::InterpreterState before_ = place_; // before the block
    gcode::Lowering lowering_ = gcode::initial_lowering(environment_);
    core::BlockClock clock_ = core::start_clock(run_.setup.machine);
    uint32_t last_line_ = 0; // of the main program
    OffsetWatch offsets_ = {};
    UnitsWatch units_ = {};
    LengthWatch lengths_ = {};
    std::set<size_t>
        moves_made_; // of the set-up's fixture moves; before the first block a restart's
    std::unique_ptr<CuredRun> cured_ = {};
    size_t followed_ = 0; // the doubt that it is about
};

} // namespace app

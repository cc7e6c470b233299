#pragma once

#include <functional>
#include <span>

#include "app/session/cured_run.h"
#include "app/session/prepared_check.h"
#include "app/session/run_place.h"

namespace app {

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
    explicit BlockRunner(const PreparedCheck& check) : check_(check), setup_(&check.run.setup) {}

    // Told of a block before it is run, when the control has read it and nothing has moved.
    std::function<void(const gcode::BlockResult&, const ProgramPlace&)> before_block;
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
    core::Result<std::optional<BlockStep>> step(RunPlace& place);

    /// Shows the blocks that come after a place of the control and what they are about to do,
    /// without carrying them out, as long as `visit` wants more; up to the end or the first error.
    void visit_ahead(gcode::InterpreterState control, gcode::Lowering lowering,
                     const BlockVisit& visit);

private:
    std::optional<core::Error> refusal(const gcode::BlockResult& block,
                                       const gcode::Lowering& lowering) const;
    /// What the interpreter remarks of a block.
    void remark_on(const gcode::BlockResult& block, const RunPlace& place,
                   std::vector<core::Finding>& findings) const;

    const PreparedCheck& check_;
    const core::Setup* setup_;
    gcode::Interpreter interpreter_{*check_.library, check_.file.environment};
    gcode::InterpreterState before_ = gcode::initial_state(check_.file.environment); // spares
                                                                                     // allocating
};

} // namespace app

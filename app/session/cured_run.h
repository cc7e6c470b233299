#pragma once

#include "app/session/length_doubt.h"
#include "app/session/offset_watch.h"
#include "gcode/lowering.h"

namespace app {

/// What a program stands on between two blocks.
struct ProgramPlace {
    const gcode::InterpreterState& at;
    const gcode::Lowering& lowering;
    const core::SimulatorState& state;
    const OffsetWatch& offsets;
    const LengthWatch& lengths;
};

/// The blocks of a length doubt as they would go if the control counted with the length that the
/// tool has. What is found there as well does not come of the length.
///
/// Cost: that of the check itself, for these blocks.
class CuredRun {
public:
    /// Begins before the first block of the doubt. Library, environment and set-up must outlive it;
    /// the library is that of the run.
    CuredRun(gcode::ProgramLibrary& library, const gcode::Environment& environment,
             const core::Setup& setup, bool speed_by_hand, const ProgramPlace& before,
             const LengthDoubt& doubt);

    /// Runs the block that the program ran under a set-up. Does nothing any more once the cured
    /// program has taken another way, or the set-up is another one.
    void follow(const gcode::BlockResult& real, const core::Setup& setup);

    /// Writes what was found into the doubt.
    void end(LengthDoubt& doubt);

private:
    void put_length_on();

    const core::Setup& setup_;
    bool speed_by_hand_;
    double length_;
    gcode::Interpreter interpreter_;
    gcode::InterpreterState place_;
    gcode::Lowering lowering_;
    core::SimulatorState state_;
    OffsetWatch offsets_;
    bool is_lost_ = false;
    std::optional<core::BlockIndex> last_; // that was followed
    std::vector<core::Finding> found_;
};

} // namespace app

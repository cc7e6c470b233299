#pragma once

#include "gcode/exec/interpreter.h"
#include "gcode/language/block.h"
#include "gcode/language/canonical.h"

namespace gcode {

/// Whether, in the active modes, a block of G0, G1, axis words, F and N is only a straight move: no
/// cycle, no compensation, no coordinate transform that a word may change, feed per minute, and no
/// rule, macro or contour waiting for a motion.
bool moves_quickly(const InterpreterState& state);

/// Executes such a block; if it contains anything else, returns false and changes nothing.
///
/// The result is that of the steps in execution.h, at a third of their cost.
bool run_quick_move(const Block& block, InterpreterState& state, BlockCommands& result);

} // namespace gcode

#pragma once

#include "gcode/exec/interpreter.h"
#include "gcode/language/block.h"
#include "gcode/language/canonical.h"

namespace gcode {

/// Whether the modes are such that a block of G0, G1, axis words, F and N is nothing but a straight
/// move: no cycle, no compensation, no map of coordinates that a word may change, feeds by the
/// minute, and no rule, macro or contour that waits for a motion.
bool moves_quickly(const InterpreterState& state);

/// Carries out such a block; false when it holds anything else, and nothing has changed then.
///
/// The outcome is that of the steps of execution.h, at a third of their cost.
bool take_quick_move(const Block& block, InterpreterState& state, BlockCommands& result);

} // namespace gcode

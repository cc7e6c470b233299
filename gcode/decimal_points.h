#pragma once

#include "gcode/interpreter.h"

namespace gcode {

/// Warns once of a program that writes some lengths with a decimal point and some without one: on
/// controls that count their smallest steps the latter are a thousandth of what they look like.
void note_points(const Block& block, InterpreterState& state, BlockResult& result);

/// Makes lengths and angles without a decimal point what a control that counts its smallest steps
/// reads: 0.001 mm, 0.0001 inch, 0.001 degrees. F, P and counts are left as they are.
void count_smallest_steps(Block& block, const ModalState& modal);

} // namespace gcode

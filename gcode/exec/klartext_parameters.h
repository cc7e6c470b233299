#pragma once

#include "gcode/exec/readings.h"

namespace gcode {

/// What a check can know of Q100 to Q199, which the control sets. TOOL CALL stores the radius, axis
/// and length of the tool.
Knowledge knowledge_of_preassigned(int number);

/// The value of a preassigned Q parameter that follows from the modes of the program; empty for
/// other parameters.
///
/// Source: TNC 640 user's manual Klartext programming, "Preassigned Q parameters".
std::optional<Value> q_parameter(const InterpreterState& state, int number);

} // namespace gcode

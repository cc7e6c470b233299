#pragma once

#include "core/base/result.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/environment.h"

namespace gcode {

/// The value of a system variable of Fanuc or Haas, depending on the dialect; empty when the number
/// is not a system variable, a vacant value if it is unknown.
///
/// Units:  lengths in the units of the program, angles in degrees.
/// Source: Fanuc B-64304, system variables, with tool compensation memory C; Haas mill operator's
///         manual, macro system variables.
std::optional<Value> fanuc_parameter(const InterpreterState& state, const Environment& environment,
                                     int number);

/// Sets a system variable that the control reacts to; returns whether the number is one. Offsets
/// change at once, and the machine does not move.
///
/// Errors: invalid_value when the variable is read-only.
core::Result<bool> set_fanuc_parameter(InterpreterState& state, const Environment& environment,
                                       int number, Value value, core::SourceSpan where);

/// Whether a system variable has the value that it has on the machine. The others hold what only
/// the machine knows, such as the wear of a tool or a setting.
bool is_modelled_variable(const Environment& environment, int number);

/// The diameter that a size of 1 under D in the offset memory stands for: 2 if sizes are radii. An
/// open premise where it is not stated.
double size_factor(InterpreterState& state, const Environment& environment, uint32_t line);

/// Whether a system variable shows a size that is a radius or a diameter.
bool is_size_of_tool(const Environment& environment, int number);

/// Whether an assignment to this variable changes an offset.
bool sets_fanuc_offset(const Environment& environment, int number);

/// Forgets what the program wrote into the variables of a tool offset number, since G10 writes it.
void forget_offset_as_set(InterpreterState& state, int number);

/// Whether this is a clock variable. Programs are checked without a clock.
bool is_of_clock(double number);

/// Advances the timers by one block, if the program has set them.
void advance_timers(InterpreterState& state);

} // namespace gcode

#pragma once

#include "core/base/result.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/environment.h"

namespace gcode {

/// The value of a system variable of Fanuc or Haas, as the dialect says; empty when the number is
/// not one of them, a vacant value if it is unknown.
///
/// Units:  lengths in those of the program, angles in degrees.
/// Source: Fanuc B-64304, system variables, with tool compensation memory C; Haas mill operator's
///         manual, macro system variables.
std::optional<Value> fanuc_parameter(const InterpreterState& state, const Environment& environment,
                                     int number);

/// Whether the number is a system variable that the control takes something from: offsets change at
/// once, and the machine stays where it is.
///
/// Errors: invalid_value when the control only shows it.
core::Result<bool> set_fanuc_parameter(InterpreterState& state, const Environment& environment,
                                       int number, Value value, core::SourceSpan where);

/// Whether this is a variable of the clock, which a program that is only read does not have.
bool is_of_clock(int number);

/// Lets the timers go on by a block, where the program has set them.
void advance_timers(InterpreterState& state);

} // namespace gcode

#pragma once

#include "gcode/exec/interpreter.h"
#include "gcode/language/environment.h"
#include "gcode/language/expression.h"

namespace gcode {

/// The numbered parameters that show the state of LinuxCNC: home (5161, 5181), G92 (5210), work
/// offsets (5220 to 5390), the tool (5400) and the position (5420). Empty for other numbers.
///
/// Units: home and offsets in the units of the machine, the position in those of the program.
std::optional<Value> linuxcnc_parameter(const InterpreterState& state,
                                        const Environment& environment, int number);

/// The predefined named parameters, such as `_x` and `_metric`, and values of the ini file, such as
/// `_ini[axis_x]max_limit`; empty for other names.
std::optional<Value> linuxcnc_parameter(const InterpreterState& state,
                                        const Environment& environment, std::string_view name);

/// Sets a parameter that LinuxCNC reads as state; returns whether the number is one. Home changes
/// at once, a work offset when it is next selected.
///
/// Errors: invalid_value when the parameter is read-only.
core::Result<bool> set_linuxcnc_parameter(InterpreterState& state, const Environment& environment,
                                          int number, Value value, core::SourceSpan where);

/// Whether setting this parameter changes an offset or a reference position.
bool sets_linuxcnc_position(int number);

/// Activates what the variables file marks as active: the work offset (5220) and G92 (5210).
///
/// The other parameters must already be in `state`.
void restore_offsets(InterpreterState& state, const Environment& environment);

} // namespace gcode

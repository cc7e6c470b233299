#pragma once

#include "gcode/exec/interpreter.h"
#include "gcode/language/environment.h"
#include "gcode/language/expression.h"

namespace gcode {

/// The numbered parameters in which LinuxCNC shows its state: home (5161, 5181), G92 (5210), work
/// offsets (5220 to 5390), the tool (5400) and the position (5420). Empty for others.
///
/// Units: home and offsets in the unit of the machine, the position in that of the program.
std::optional<Value> linuxcnc_parameter(const InterpreterState& state,
                                        const Environment& environment, int number);

/// The predefined named parameters, such as `_x` and `_metric`, and the values of the ini file,
/// such as `_ini[axis_x]max_limit`; empty for any other.
std::optional<Value> linuxcnc_parameter(const InterpreterState& state,
                                        const Environment& environment, std::string_view name);

/// Whether the number is one in which LinuxCNC takes its state; home follows at once, a work offset
/// when it is selected again.
///
/// Errors: invalid_value when the control only shows it.
core::Result<bool> set_linuxcnc_parameter(InterpreterState& state, const Environment& environment,
                                          int number, Value value, core::SourceSpan where);

/// Brings into effect what a variables file says is on: the work offset (5220) and G92 (5210).
///
/// `state` has the other parameters already.
void begin_with_kept_offsets(InterpreterState& state, const Environment& environment);

} // namespace gcode

#pragma once

#include "gcode/exec/flow.h"

namespace gcode {

/// Carries out a flow statement of native Siemens: jumps, loops, branches, calls, declarations.
core::Result<void> run_siemens_flow(const FlowStep& step);

/// The lines of the program that a line stands in: a file may hold several, each behind a header.
struct ProgramLines {
    uint32_t begin = 1, end = UINT32_MAX; // the end is not of it
};
ProgramLines lines_around(const FlowIndex& index, uint32_t line);

/// Calls a program by its name, with the values of its parameters.
///
/// Errors: syntax when there is no such program, or the arguments do not fit its parameters.
core::Result<void> call_siemens_program(const FlowStep& step);

/// The level that a call of a program begins, its parameters set.
core::Result<Frame> called_frame(const FlowStep& step);

/// Gives the variables of DEF their first values.
core::Result<void> declare_variables(const FlowStep& step);

/// The value of an argument.
core::Result<double> value_of_argument(const FlowStep& step, const SiemensArgument& argument);

/// A value as a variable of a type holds it.
double held_as(SiemensType type, double value);

} // namespace gcode

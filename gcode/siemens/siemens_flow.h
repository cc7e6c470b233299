#pragma once

#include "gcode/exec/flow.h"
#include "gcode/siemens/siemens_line.h"

namespace gcode {

/// Runs a flow statement of native Siemens: jumps, loops, branches, calls, declarations.
core::Result<void> run_siemens_flow(const FlowStep& step);

/// The lines of the program to which a line belongs: a file may hold several programs, each after a
/// header.
struct ProgramLines {
    uint32_t begin = 1, end = UINT32_MAX; // first line and the line after the last
};
ProgramLines lines_around(const FlowIndex& index, uint32_t line);

/// Calls a program by name with the values of its parameters.
///
/// Errors: syntax when the program does not exist or the arguments do not match its parameters.
core::Result<void> call_siemens_program(const FlowStep& step);

/// The call level for a program call, with its parameters set.
core::Result<Frame> called_frame(const FlowStep& step);

/// SAVE: what a call level restores at each return.
void save_siemens_modes(const InterpreterState& state, Frame& frame);

/// Whether a subprogram with SAVE is being run.
bool is_within_save(const InterpreterState& state);

/// Returns from a called program and emits the commands for the modes that this restores.
void return_to_caller(InterpreterState& state, BlockCommands& result, uint32_t column);

/// Ends the main program at a word that ends subprograms, M17 or RET, as M30 does.
void end_main_program(InterpreterState& state, BlockCommands& result, uint32_t column,
                      std::string_view word);

/// Initialises the variables declared by DEF.
core::Result<void> declare_variables(const FlowStep& step);

/// The value of an argument.
core::Result<double> value_of_argument(const FlowStep& step, const SiemensArgument& argument,
                                       bool is_condition = false);

} // namespace gcode

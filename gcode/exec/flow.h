#pragma once

#include "gcode/exec/interpreter.h"
#include "gcode/exec/program_parameters.h"
#include "gcode/language/block.h"

namespace gcode {

/// A flow statement on its way.
struct FlowStep {
    ProgramLibrary& library;
    const Environment& environment;
    const Dialect& dialect;
    const Block& block;
    InterpreterState& state;
    BlockCommands& result;
};

/// Carries out a flow statement: sets the line that is run next, calls and returns.
///
/// Effect: on an error nothing has changed.
/// Errors: syntax when the other end of a loop or branch is missing, or a subprogram is not to be
///         found; invalid_value when calls go too deep.
core::Result<void> run_flow(const FlowStep& step);

/// Whether the condition of a block holds.
core::Result<bool> condition_holds(const Block& block, const ProgramParameters& parameters,
                                   const Dialect& dialect);

/// Goes to a level of its own, whose first line is given.
///
/// Errors: invalid_value when calls go too deep.
core::Result<void> enter(InterpreterState& state, const Environment& environment, Frame frame,
                         core::SourceSpan where);

/// Leaves the level that runs for the line behind the call, or for another round of it.
void leave(InterpreterState& state);

/// Leaves the level that runs, whatever rounds were to come, for a line of the program that called.
void leave_to(InterpreterState& state, uint32_t line);

/// The line of a block number in a program: looked for behind a line, then from the program's
/// beginning; empty when there is none. A program of a file with several ends where the next one
/// begins.
std::optional<uint32_t> line_of_block(ProgramLibrary& library, uint32_t source, double number,
                                      uint32_t from);

/// Looks whether a jump back from a place has led to a state the program was in before.
///
/// Errors: invalid_value then: it will never end.
core::Result<void> watch_for_endless_loop(InterpreterState& state, Place from);

} // namespace gcode

#pragma once

#include <string>
#include <utility>

#include "core/base/result.h"
#include "gcode/exec/interpreter.h"
#include "gcode/exec/program_parameters.h"
#include "gcode/language/block.h"
#include "gcode/language/dialect.h"

namespace gcode {

/// A flow statement being executed.
struct FlowStep {
    ProgramLibrary& library;
    const Environment& environment;
    const Dialect& dialect;
    const Block& block;
    InterpreterState& state;
    BlockCommands& result;
};

/// A syntax error at the flow statement.
inline tl::unexpected<core::Error> refuse_step(const FlowStep& step, std::string message) {
    return core::fail(core::ErrorCode::syntax, std::move(message), step.block.flow.span);
}

/// Executes a flow statement: sets the line to be executed next, calls and returns.
///
/// Effect: on an error nothing has changed.
/// Errors: syntax when the other end of a loop or branch is missing, or a subprogram is not found;
///         invalid_value when calls are nested too deeply.
core::Result<void> run_flow(const FlowStep& step);

/// Evaluates the condition of a block, and notes it for the search for endless loops.
core::Result<bool> condition_holds(InterpreterState& state, const Block& block,
                                   const ProgramParameters& parameters, const Dialect& dialect);

/// Enters a new call level at its first line.
///
/// Errors: invalid_value when calls are nested too deeply.
core::Result<void> enter(InterpreterState& state, const Environment& environment, Frame frame,
                         core::SourceSpan where);

/// Returns from the current call level to the line after the call, or starts its next repetition.
void leave(InterpreterState& state);

/// Returns from the current call level to a line of the caller, without further repetitions.
void leave_to(InterpreterState& state, uint32_t line);

/// The line with a block number in a program. The search starts after a line and continues from the
/// start of the program; empty if there is none. In a file with several programs, each ends where
/// the next begins.
std::optional<uint32_t> line_of_block(ProgramLibrary& library, uint32_t source, double number,
                                      uint32_t from);

} // namespace gcode

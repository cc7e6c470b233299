#pragma once

#include "core/base/result.h"

namespace gcode {

struct Environment;
struct InterpreterState;

/// Executes the start-up code of the environment, which sets modes, offsets and parameters before
/// the first block, as LinuxCNC's RS274NGC_STARTUP_CODE. Does nothing if there is none.
///
/// Errors: those of the code; unsupported if it moves the machine or changes the tool. Then `state`
///         is unchanged.
core::Result<void> run_startup_code(InterpreterState& state, const Environment& environment);

} // namespace gcode

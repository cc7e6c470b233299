#pragma once

#include <string>

#include "gcode/exec/interpreter.h"
#include "gcode/language/environment.h"
#include "tests/support/plain_command.h"

namespace test_support {

/// The control as the reference starts: LinuxCNC's dialect, at 0, 0, 0, with the tools of
/// `reference_tools`.
gcode::Environment reference_environment();

/// A run of our interpreter as plain commands.
PlainRun plain_run(const gcode::Run& run);

/// What our interpreter makes of a program in `reference_environment`.
PlainRun run_feeler(const std::string& program);

} // namespace test_support

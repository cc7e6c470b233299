#pragma once

#include <string>

#include "gcode/language/environment.h"
#include "tests/support/plain_command.h"
#include "tests/support/whole_run.h"

namespace test_support {

/// The start state of the reference: LinuxCNC's dialect, at 0, 0, 0, with the tools of
/// `reference_tools`.
gcode::Environment reference_environment();

/// Converts a run of our interpreter to plain commands.
PlainRun plain_run(const gcode::Run& run);

/// Runs a program with our interpreter in `reference_environment`.
PlainRun run_feeler(const std::string& program);

} // namespace test_support

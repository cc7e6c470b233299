#pragma once

#include <string>
#include <vector>

#include "tests/support/plain_command.h"

namespace test_support {

/// A row of the tool table with which every reference run starts.
struct ReferenceTool {
    int number;
    Axes offset;
    double diameter, front_deg, back_deg;
    int orientation;
};

/// Tools 1 to 9: mills, one with offsets along all axes, one for turning.
const std::vector<ReferenceTool>& reference_tools();

/// Whether LinuxCNC's interpreter is installed with its Python module.
bool reference_is_installed();

/// Runs programs with LinuxCNC's interpreter, one result for each: from 0, 0, 0, in mm, with the
/// tools of `reference_tools` and no variables.
///
/// Cost: about 80 ms for each program, and 0.1 s.
std::vector<PlainRun> run_reference(const std::vector<std::string>& programs);

} // namespace test_support

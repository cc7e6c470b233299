#pragma once

#include <string>

#include "tests/support/plain_command.h"

namespace test_support {

/// A run written as a LinuxCNC program without modal dependencies: absolute positions and centres
/// in mm, a feed in each feed move, offsets written before they take effect. It does the same as
/// the run.
///
/// Errors: throws std::invalid_argument for commands that it cannot write: probing, threads, arcs
///         outside the three main planes.
std::string canonical_program(const PlainRun& run);

} // namespace test_support

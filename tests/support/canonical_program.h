#pragma once

#include <string>

#include "tests/support/plain_command.h"

namespace test_support {

/// A run written out as a program of LinuxCNC's dialect with nothing modal left to think about:
/// absolute places and centres in mm, a feed in every feed, offsets written before they count. It
/// does what the run did.
///
/// Errors: throws std::invalid_argument for a command that it has no way to write: probing,
///         threads, arcs outside of the three main planes.
std::string canonical_program(const PlainRun& run);

} // namespace test_support

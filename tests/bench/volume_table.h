#pragma once

#include <span>

#include "tests/bench/machining_scenes.h"

namespace bench {

/// Runs the scenes on devices with boxes and with the paper's spheres, for records and for the
/// points of scans at h = 0.5, and the case study of the paper; prints the tables. False if two
/// devices disagree.
bool print_volumes(std::span<const MachiningScene> scenes);

} // namespace bench

#pragma once

#include <span>

#include "tests/bench/machining_scenes.h"

namespace bench {

/// Prints the work and time of a thread with boxes and with the paper's spheres, for records and
/// for the points of scans at h = 0.5. False if two searches disagree.
bool print_volumes(std::span<const MachiningScene> scenes);

} // namespace bench

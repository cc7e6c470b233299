#pragma once

#include <span>

#include "tests/bench/machining_scenes.h"

namespace bench {

/// Prints what a thread does and how long it takes, by boxes and by the paper's spheres, among
/// records and among the points of scans at h = 0.5. False if two searches do not agree.
bool print_volumes(std::span<const MachiningScene> scenes);

} // namespace bench

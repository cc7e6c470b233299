#pragma once

#include "core/distance/body_distance.h"
#include "hwsim/memory_line.h"

namespace hwsim {

/// Upright posts that together hold every point of a body, in its own frame: its columns on a grid
/// of this spacing. Of a convex shape that is neither an upright piece of revolution nor a box they
/// hold the box round it.
///
/// Errors: what does not fit into the device's numbers.
core::Result<std::vector<Record>> posts_round(const core::ExactBody& body, double spacing);

} // namespace hwsim

#pragma once

#include <vector>

#include "core/geom/profile.h"
#include "hwsim/memory_line.h"

namespace hwsim {

/// Upright cylinders that together hold every point of the pieces of a body of revolution, placed
/// by its own origin.
///
/// Result: no point of a cylinder is farther than `tolerance` and two steps of rounding from the
///         pieces, or the tolerance asks for more than 4096 cylinders of one piece, which then are
///         the limit. The profile's form error is not added.
/// Errors: no pieces, a tolerance that is not positive, what does not fit into the device's
/// numbers.
core::Result<std::vector<Record>> cylinders_round(const core::RevolvedProfile& profile,
                                                  double tolerance);

/// Upright cylinders that hold the same as these posts: what stands for a body of the tool's side
/// that is no body of revolution. They reach 0.42 of the half side farther than the posts.
std::vector<Record> cylinders_round(const std::vector<Record>& posts);

} // namespace hwsim

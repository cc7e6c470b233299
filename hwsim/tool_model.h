#pragma once

#include <vector>

#include "core/geom/profile.h"
#include "hwsim/memory_line.h"

namespace hwsim {

/// Upright cylinders that together contain the pieces of a body of revolution, relative to its own
/// origin.
///
/// Result:  no point of a cylinder is farther from the pieces than `tolerance` plus two steps of
///          rounding, unless one piece would need more than 4096 cylinders, which is the limit. The
///          form error of the profile is not added.
/// Errors:  no pieces; a tolerance that is not positive; coordinates out of the device's range.
core::Result<std::vector<Record>> cylinders_round(const core::RevolvedProfile& profile,
                                                  double tolerance);

/// Upright cylinders that contain these posts, for a body of the tool side that is not a body of
/// revolution. They are larger than the posts by 0.42 of the half side.
std::vector<Record> cylinders_round(const std::vector<Record>& posts);

} // namespace hwsim

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

/// Upright posts that together hold every point of a body of revolution that is turned about its
/// origin. A point of it over a cell is no farther from the line through the cell's middle than
/// half the cell's diagonal, so the column reaches as far as that line is in the body grown by so
/// much.
core::Result<std::vector<Record>> posts_round(const core::RevolvedProfile& profile, double spacing,
                                              const core::Mat3& orientation);

/// Cubes that together hold every point of a body's surface, in its own frame: what turns with the
/// machine is covered again for each way it is held, and scanned but once.
struct CubeCover {
    double side = 0.0;
    std::vector<core::Vec3> centres;
};

CubeCover cubes_round(const core::ExactBody& body, double side);

/// Upright cylinders round the cubes, turned about the body's origin.
///
/// Errors: what does not fit into the device's numbers.
core::Result<std::vector<Record>> cylinders_round(const CubeCover& cubes,
                                                  const core::Mat3& orientation);

} // namespace hwsim

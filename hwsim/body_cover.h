#pragma once

#include "core/distance/body_distance.h"
#include "hwsim/memory_line.h"

namespace hwsim {

/// Upright posts that together contain a body, in its own frame: its columns on a grid of this
/// spacing. A convex shape that is neither an upright piece of revolution nor a box is covered by
/// its box.
///
/// Errors:  coordinates out of the device's range.
core::Result<std::vector<Record>> posts_round(const core::ExactBody& body, double spacing);

/// Upright posts that together contain a body of revolution rotated about its origin. A point of it
/// over a cell is within half the cell diagonal of the line through the cell centre, so the column
/// spans that line's segment inside the body grown by that distance.
core::Result<std::vector<Record>> posts_round(const core::RevolvedProfile& profile, double spacing,
                                              const core::Mat3& orientation);

/// Cubes that together contain the surface of a body, in its own frame. A body that rotates with
/// the machine is scanned once and covered again for each orientation.
struct CubeCover {
    double side = 0.0;
    std::vector<core::Vec3> centres;
};

CubeCover cubes_round(const core::ExactBody& body, double side);

/// Upright cylinders around the cubes, rotated about the origin of the body.
///
/// Errors:  coordinates out of the device's range.
core::Result<std::vector<Record>> cylinders_round(const CubeCover& cubes,
                                                  const core::Mat3& orientation);

} // namespace hwsim

#pragma once

#include <array>

#include "core/distance/upright_sweep.h"

namespace core {

/// Encloses a shape along its path, for cheap bounds of its distance to boxes: a piece of
/// revolution if the shape is one or has an upright one around it and moves straight; a box; and
/// slabs if the path is a triangle or a tetrahedron or the shape is a hull of points that is not
/// upright.
struct ShapeOutline {
    /// The shape is between two planes: low <= normal * point <= high.
    struct Slab {
        Vec3 normal; // of length 1
        double low, high;
    };
    static constexpr size_t max_slabs = 7;

    Aabb box;              // around the whole sweep
    bool straight = false; // `sweep` is valid: one or two places
    bool exact = false;    // `sweep` is the shape itself: distances are exact
    bool tilted = false;   // the axis of `sweep` is the Z axis of `orientation`
    UprightSweep sweep;
    Mat3 orientation = Mat3(1.0);
    std::array<Slab, max_slabs> slabs;
    size_t slab_count = 0;
};

ShapeOutline outline(const ConvexShape& shape);

/// A lower bound of the distance between the shape and a box; 0 if they may overlap. Tight only
/// where it may be below `limit`; exact up to 1e-7 mm if the outline is exact.
double distance_bound(const ShapeOutline& shape, const Aabb& box, double limit);

} // namespace core

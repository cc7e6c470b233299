#pragma once

#include "core/geom/gjk.h"

namespace core {

/// A convex piece of a body of revolution with its axis along Z, and its straight motion.
struct UprightSweep {
    ProfileElement element;
    Vec3 from = Vec3(0.0); // position of the element's origin
    Vec3 by = Vec3(0.0);   // displacement; zero: at rest
};

/// The distance from a moving piece to a box.
///
/// Result:  bounds of the least distance over the whole motion, no farther apart than
///          `goal.tolerance` unless `lower` is at least `goal.limit`, and the points and the time
///          that give `upper`. A box may be flat or a line.
/// Cost:    one evaluation of the piece if that decides, usually two, rarely ten. Source:
/// README.md, "Upright pieces".
Separation separation(const UprightSweep& sweep, const Aabb& box, const SeparationGoal& goal = {});

/// The lower bound of separation().
double distance_bound(const UprightSweep& sweep, const Aabb& box, double limit);

/// Encloses a shape along its path, for cheap bounds of its distance to boxes: an upright piece of
/// revolution if the shape has one and moves straight, otherwise a box, cut by slabs if the path is
/// a triangle or a tetrahedron.
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
    UprightSweep sweep;
    std::array<Slab, max_slabs> slabs;
    size_t slab_count = 0;
};

ShapeOutline outline(const ConvexShape& shape);

/// A lower bound of the distance between the shape and a box; 0 if they may overlap. Tight only
/// where it may be below `limit`; exact up to 1e-7 mm if the outline is exact.
double distance_bound(const ShapeOutline& shape, const Aabb& box, double limit);

} // namespace core

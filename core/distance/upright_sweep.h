#pragma once

#include "core/geom/gjk.h"

namespace core {

/// A convex piece of a body of revolution whose axis is along Z, and a straight motion of it.
struct UprightSweep {
    ProfileElement element;
    Vec3 from = Vec3(0.0); // of the element's origin
    Vec3 by = Vec3(0.0);   // the motion; zero: the piece stands still
};

/// The distance from a piece that stands somewhere on its way to a box.
///
/// Result: bounds of the least distance over the whole motion, no farther apart than
///         `goal.tolerance` unless `lower` is at least `goal.limit`, and the points and the time
///         that give `upper`. A box may be flat or thin as a line.
/// Cost:   the piece is looked at once where that decides, mostly twice, seldom ten times.
/// Source: README.md beside this file, "Upright pieces".
Separation separation(const UprightSweep& sweep, const Aabb& box, const SeparationGoal& goal = {});

/// `lower` of the same alone.
double distance_bound(const UprightSweep& sweep, const Aabb& box, double limit);

/// What holds a shape along its path, for bounds of its distance to boxes that cost little: an
/// upright piece of revolution where the shape has one and goes straight, a box else.
struct ShapeOutline {
    Aabb box;              // round the whole sweep
    bool straight = false; // the sweep holds: one or two places
    bool exact = false;    // the sweep is the shape's own: its distances are true
    UprightSweep sweep;
};

ShapeOutline outline(const ConvexShape& shape);

/// A lower bound of the distance between the shape and a box; 0 when they may meet. The best one
/// only where it may be below `limit`; where the outline is exact, the distance but for 1e-7 mm.
double distance_bound(const ShapeOutline& shape, const Aabb& box, double limit);

} // namespace core

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

} // namespace core

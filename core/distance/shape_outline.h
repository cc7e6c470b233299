#pragma once

#include "core/distance/upright_sweep.h"

namespace core {

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

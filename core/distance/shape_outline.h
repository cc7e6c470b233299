#pragma once

#include "core/geom/convex.h"

namespace core {

/// An upright cylinder round a shape, moved along the shape's path: a bound of the distance to
/// boxes that costs little and is exact for flat faces and walls along a straight path.
struct ShapeOutline {
    Aabb box;                                      // round the whole sweep
    bool straight = false;                         // the rest holds: one or two places
    double x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0; // path of the axis seen from above
    double radius = 0.0;
    bool exact = false; // the sweep is this cylinder's: its bounds are true distances
};

ShapeOutline outline(const ConvexShape& shape);

/// A lower bound of the distance between the shape and a box; 0 when they may meet. The best one
/// only where it may be below `limit`.
double distance_bound(const ShapeOutline& shape, const Aabb& box, double limit);

} // namespace core

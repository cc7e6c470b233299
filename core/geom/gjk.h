#pragma once

#include "core/geom/convex.h"

namespace core {

/// How far two bodies are apart: lower <= true distance <= upper, and the points that give `upper`.
struct Separation {
    double lower = infinity;
    double upper = infinity;
    Vec3 point_a = Vec3(0.0), point_b = Vec3(0.0); // on A and on B; equal when they overlap
    double time_a = 0.0;                           // when in A's sweep, 0..1

    bool found() const { return upper < infinity; }
};

/// When a search for the distance of two convex shapes may end.
struct SeparationGoal {
    double tolerance = 1e-7; // mm: ends when upper - lower is no wider
    double limit = infinity; // mm: ends when lower is at least this; upper need not be tight then
};

/// The distance between two convex shapes.
///
/// Result: both bounds hold however the search ends: `lower` comes from a separating plane, `upper`
///         from a pair of points, each computed afresh from the support functions. Overlap gives 0.
///         Rounding is below 1e-9 mm for coordinates within 2 m and is not subtracted here.
/// Cost:   some 3-20 supports of each shape; 1-3 when `limit` decides.
/// Source: Gilbert, Johnson, Keerthi 1988; sub-distances as in Ericson, Real-Time Collision
///         Detection, 5.1.
Separation separation(const ConvexShape& a, const ConvexShape& b, const SeparationGoal& goal = {});

} // namespace core

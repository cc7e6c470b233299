#pragma once

#include "core/geom/gjk.h"
#include "core/geom/mesh.h"

namespace core {

/// The point of a triangle nearest to `p`, also of one without area.
Vec3 nearest_point(const Triangle& triangle, const Vec3& p);

/// The distance between two triangles in closed form, also of slivers and of triangles without
/// area.
///
/// Result: both bounds hold as those of convex shapes do: `lower` comes from a plane between the
///         triangles, `upper` from a point of each. 0 when they meet.
/// Cost:   some 0.2 us; GJK is asked when rounding leaves more than the tolerance open.
/// Source: the order of the tests is that of Larsen, Gottschalk, Lin, Manocha, Fast Proximity
///         Queries with Swept Sphere Volumes, 1999.
Separation separation(const Triangle& a, const Triangle& b, const SeparationGoal& goal = {});

} // namespace core

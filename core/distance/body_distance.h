#pragma once

#include <span>
#include <variant>
#include <vector>

#include "core/geom/gjk.h"
#include "core/geom/mesh.h"

namespace core {

/// A body with an exactly known surface: a convex shape or a closed mesh.
using ExactBody = std::variant<ConvexShape, SolidMesh>;

Aabb bounds(const ExactBody& body);

/// The distance between a convex shape over its sweep and a body, interiors included.
///
/// Result:  as for separation() of two shapes; also 0 if one is wholly inside the other. `upper` is
///          infinite if nothing is within `goal.limit`; `lower` is at most the limit.
Separation separation(const ConvexShape& shape, const ExactBody& body,
                      const SeparationGoal& goal = {});

/// The least distance between two bodies while B moves straight from its pose by `sweep`.
Separation separation(const ExactBody& a, const ExactBody& b, const Transform& a_from_b,
                      const Vec3& sweep, const SeparationGoal& goal = {});

/// A ball inside a body, in its frame.
struct InnerBall {
    Vec3 centre = Vec3(0.0);
    double radius = 0.0;
};

/// Balls inside a body, around the points of a grid, each as large as `inner_depth` allows. They do
/// not fill it: of what overlaps the body by a hundredth of its size, they meet most.
///
/// Cost: some thousand calls of inner_depth.
std::vector<InnerBall> inner_balls(const ExactBody& body);

} // namespace core

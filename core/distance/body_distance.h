#pragma once

#include <span>
#include <variant>

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

} // namespace core

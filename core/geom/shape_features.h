#pragma once

#include <optional>

#include "core/geom/gjk.h"
#include "core/geom/mesh_features.h"

namespace core {

/// Six faces, twelve edges and eight corners.
MeshFeatures features_of(const Aabb& box);

/// A cylinder or truncated cone about the line from `from` to `to`: two faces, two rims and one
/// boss. A radius of 0 gives a tip. Its loops are polygons for display; all else is exact.
MeshFeatures cone_features(const Vec3& from, const Vec3& to, double radius_from, double radius_to);

/// The triangles of a box in any pose whose points are in the order of convex(Aabb); empty for
/// other shapes.
std::optional<Mesh> mesh_of_box(const ConvexShape& shape);

/// The features of a box, cylinder or cone at its first position. Other shapes (balls, and shapes
/// with a margin) have none.
MeshFeatures features_of(const ConvexShape& shape);

} // namespace core

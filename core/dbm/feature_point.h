#pragma once

#include <span>

#include "core/base/vec.h"

namespace core {

/// The plane on which a surface lies near one of its points: normals are out of the body.
struct TangentPlane {
    Vec3 place = Vec3(0.0);
    Vec3 normal = Vec3(0.0); // length 1
};

/// The point of a box that lies on all the tangent planes of a surface at once, as nearly as
/// possible: on a face if they are one plane, on an edge or corner where they are not; else as near
/// to the middle of the points as the planes leave it.
///
/// Source: Ju, Losasso, Schaefer, Warren: Dual contouring of Hermite data, 2002.
Vec3 feature_point(std::span<const TangentPlane> points, const Aabb& room);

} // namespace core

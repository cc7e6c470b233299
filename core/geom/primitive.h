#pragma once

#include <variant>

#include "core/base/result.h"
#include "core/base/vec.h"

namespace core {

struct Sphere {
    double radius = 0.0;
};

struct Box {
    Vec3 size = Vec3(0.0); // full sizes
};

/// A cylinder about the Z axis.
struct Cylinder {
    double radius = 0.0;
    double height = 0.0;
};

/// A body of simple shape, centred on the origin, mm.
using Primitive = std::variant<Sphere, Box, Cylinder>;

Aabb bounds(const Primitive& primitive);

/// The primitive itself if all its sizes are positive and finite.
Result<Primitive> checked_primitive(const Primitive& primitive);

} // namespace core

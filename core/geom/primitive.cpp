#include "core/geom/primitive.h"

#include <fmt/format.h>

namespace core {
namespace {

Vec3 size_of(const Sphere& s) { return Vec3(2.0 * s.radius); }
Vec3 size_of(const Box& b) { return b.size; }
Vec3 size_of(const Cylinder& c) { return {2.0 * c.radius, 2.0 * c.radius, c.height}; }

const char* name_of(const Sphere&) { return "sphere"; }
const char* name_of(const Box&) { return "box"; }
const char* name_of(const Cylinder&) { return "cylinder"; }

} // namespace

Aabb bounds(const Primitive& primitive) {
    const Vec3 half = 0.5 * std::visit([](const auto& shape) { return size_of(shape); }, primitive);
    return {-half, half};
}

Result<Primitive> checked_primitive(const Primitive& primitive) {
    const Vec3 size = bounds(primitive).size();
    for (int axis = 0; axis < 3; ++axis)
        if (!(size[axis] > 0.0) || !std::isfinite(size[axis]))
            return fail(ErrorCode::invalid_value,
                        fmt::format("a {} needs sizes above 0 mm, but one of them is {}",
                                    std::visit([](const auto& s) { return name_of(s); }, primitive),
                                    size[axis]));
    return primitive;
}

} // namespace core

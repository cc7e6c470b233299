#include "core/geom/convex.h"

#include <cassert>

namespace core {
namespace {

/// Farthest point of an upright truncated cone about Z.
Vec3 cone_support(const ProfileElement& cone, const Vec3& direction) {
    const double across = std::hypot(direction.x, direction.y);
    const double lower = cone.r0 * across + cone.z0 * direction.z;
    const double upper = cone.r1 * across + cone.z1 * direction.z;
    const double r = upper > lower ? cone.r1 : cone.r0;
    const double z = upper > lower ? cone.z1 : cone.z0;
    if (across == 0.0) return {r, 0.0, z};
    return {direction.x * (r / across), direction.y * (r / across), z};
}

Vec3 core_support(const ConvexShape& shape, const Vec3& direction) {
    if (shape.core == ConvexShape::Core::cone) {
        if (shape.upright) return cone_support(shape.cone, direction);
        const Vec3 local = glm::transpose(shape.orientation) * direction;
        return shape.orientation * cone_support(shape.cone, local);
    }
    size_t best = 0;
    double farthest = glm::dot(shape.points[0], direction);
    for (size_t i = 1; i < shape.point_count; ++i) {
        const double along = glm::dot(shape.points[i], direction);
        if (along <= farthest) continue;
        farthest = along;
        best = i;
    }
    return shape.points[best];
}

} // namespace

ConvexShape convex(const Triangle& triangle) {
    ConvexShape shape;
    shape.point_count = 3;
    shape.points[0] = triangle.a;
    shape.points[1] = triangle.b;
    shape.points[2] = triangle.c;
    return shape;
}

ConvexShape convex(const Aabb& box) {
    ConvexShape shape;
    shape.point_count = 8;
    for (size_t i = 0; i < 8; ++i)
        shape.points[i] = {i & 1U ? box.max.x : box.min.x, i & 2U ? box.max.y : box.min.y,
                           i & 4U ? box.max.z : box.min.z};
    return shape;
}

ConvexShape convex_segment(const Vec3& a, const Vec3& b) {
    ConvexShape shape;
    shape.point_count = 2;
    shape.points[0] = a;
    shape.points[1] = b;
    return shape;
}

ConvexShape convex(const ProfileElement& element) {
    ConvexShape shape;
    shape.margin = element.margin;
    if (element.r0 == 0.0 && element.r1 == 0.0) { // a ball, or the sweep of one along its axis
        shape.point_count = 2;
        shape.points[0] = {0.0, 0.0, element.z0};
        shape.points[1] = {0.0, 0.0, element.z1};
        return shape;
    }
    shape.core = ConvexShape::Core::cone;
    shape.cone = element;
    return shape;
}

ConvexShape convex_sphere(double radius) {
    ConvexShape shape;
    shape.point_count = 1;
    shape.margin = radius;
    return shape;
}

ConvexShape posed(const ConvexShape& shape, const Transform& target_from_shape) {
    assert(shape.place_count == 1);
    ConvexShape result = shape;
    for (size_t i = 0; i < shape.point_count; ++i)
        result.points[i] = target_from_shape.rotation * shape.points[i];
    result.orientation = target_from_shape.rotation * shape.orientation;
    result.upright = result.orientation == Mat3(1.0);
    result.places[0].at = target_from_shape * shape.places[0].at;
    return result;
}

ConvexShape swept(const ConvexShape& shape, std::span<const Vec3> places) {
    assert(!places.empty() && places.size() <= ConvexShape::max_places && shape.place_count == 1);
    ConvexShape result = shape;
    result.place_count = static_cast<uint8_t>(places.size());
    const double last = std::max<double>(1.0, static_cast<double>(places.size()) - 1.0);
    for (size_t i = 0; i < places.size(); ++i)
        result.places[i] = {shape.places[0].at + places[i], static_cast<double>(i) / last};
    return result;
}

SupportPoint support(const ConvexShape& shape, const Vec3& direction) {
    size_t best = 0;
    double farthest = glm::dot(shape.places[0].at, direction);
    for (size_t i = 1; i < shape.place_count; ++i) {
        const double along = glm::dot(shape.places[i].at, direction);
        if (along <= farthest) continue;
        farthest = along;
        best = i;
    }
    return {core_support(shape, direction) + shape.places[best].at, shape.places[best].time};
}

Aabb bounds(const ConvexShape& shape) {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 direction(0.0);
        direction[axis] = 1.0;
        box.max[axis] = support(shape, direction).point[axis] + shape.margin;
        box.min[axis] = support(shape, -direction).point[axis] - shape.margin;
    }
    return box;
}

} // namespace core

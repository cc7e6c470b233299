#include "core/distance/shape_outline.h"

#include <algorithm>
#include <cmath>

namespace core {
namespace {

/// The upright cylinder round points, about the origin's axis.
ProfileElement cylinder_round(std::span<const Vec3> points, double margin) {
    ProfileElement element{.z0 = infinity, .z1 = -infinity, .margin = margin};
    for (const Vec3& point : points) {
        element.r0 = std::max(element.r0, std::hypot(point.x, point.y));
        element.z0 = std::min(element.z0, point.z);
        element.z1 = std::max(element.z1, point.z);
    }
    element.r1 = element.r0;
    return element;
}

} // namespace

ShapeOutline outline(const ConvexShape& shape) {
    ShapeOutline result{.box = bounds(shape)};
    result.straight = shape.place_count <= 2 && shape.upright;
    if (!result.straight) return result;
    result.sweep.from = shape.places[0].at;
    result.sweep.by = shape.places[shape.place_count - 1U].at - shape.places[0].at;
    result.exact = shape.core == ConvexShape::Core::cone;
    result.sweep.element =
        result.exact ? shape.cone
                     : cylinder_round({shape.points.data(), shape.point_count}, shape.margin);
    result.sweep.element.margin = shape.margin;
    return result;
}

double distance_bound(const ShapeOutline& shape, const Aabb& box, double limit) {
    const double by_boxes = distance(shape.box, box);
    if (!shape.straight || by_boxes >= limit) return by_boxes;
    return std::max(by_boxes, distance_bound(shape.sweep, box, limit));
}

} // namespace core

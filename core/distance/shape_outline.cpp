#include "core/distance/shape_outline.h"

namespace core {
namespace {

double squared(double x, double y) { return x * x + y * y; }

/// Squared distance from a point to the outline's path, seen from above.
double to_path(const ShapeOutline& s, double x, double y) {
    const double dx = s.x1 - s.x0, dy = s.y1 - s.y0;
    const double length = squared(dx, dy);
    const double along = (x - s.x0) * dx + (y - s.y0) * dy;
    const double t = length > 0.0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
    return squared(x - s.x0 - t * dx, y - s.y0 - t * dy);
}

double to_rectangle(const Aabb& box, double x, double y) {
    return squared(std::max({box.min.x - x, x - box.max.x, 0.0}),
                   std::max({box.min.y - y, y - box.max.y, 0.0}));
}

/// Whether the path passes through the rectangle, ends outside it (separating axes).
bool crosses(const ShapeOutline& s, const Aabb& box) {
    if (std::max(s.x0, s.x1) < box.min.x || std::min(s.x0, s.x1) > box.max.x
        || std::max(s.y0, s.y1) < box.min.y || std::min(s.y0, s.y1) > box.max.y)
        return false;
    const double dx = s.x1 - s.x0, dy = s.y1 - s.y0;
    const auto side = [&](double x, double y) { return dx * (y - s.y0) - dy * (x - s.x0); };
    const double a = side(box.min.x, box.min.y), b = side(box.max.x, box.min.y);
    const double c = side(box.min.x, box.max.y), d = side(box.max.x, box.max.y);
    return !((a > 0 && b > 0 && c > 0 && d > 0) || (a < 0 && b < 0 && c < 0 && d < 0));
}

/// Distance between the path and the rectangle, seen from above.
double path_to_rectangle(const ShapeOutline& s, const Aabb& box) {
    if (crosses(s, box)) return 0.0;
    // Two convex sets apart: a corner of one is nearest, or an end of the other.
    const double ends = std::min(to_rectangle(box, s.x0, s.y0), to_rectangle(box, s.x1, s.y1));
    if (box.min.x == box.max.x && box.min.y == box.max.y)
        return std::sqrt(to_path(s, box.min.x, box.min.y));
    const double corners =
        std::min({to_path(s, box.min.x, box.min.y), to_path(s, box.max.x, box.min.y),
                  to_path(s, box.min.x, box.max.y), to_path(s, box.max.x, box.max.y)});
    return std::sqrt(std::min(ends, corners));
}

} // namespace

ShapeOutline outline(const ConvexShape& shape) {
    ShapeOutline result{.box = bounds(shape)};
    result.straight = shape.place_count <= 2 && shape.upright;
    const Vec3 from = shape.places[0].at;
    const Vec3 to = shape.places[shape.place_count - 1U].at;
    result.x0 = from.x;
    result.y0 = from.y;
    result.x1 = to.x;
    result.y1 = to.y;
    double core_radius = std::max(shape.cone.r0, shape.cone.r1);
    if (shape.core == ConvexShape::Core::points) {
        core_radius = 0.0;
        for (size_t i = 0; i < shape.point_count; ++i)
            core_radius = std::max(core_radius, std::hypot(shape.points[i].x, shape.points[i].y));
    }
    result.radius = core_radius + shape.margin;
    // A cylinder that goes level sweeps all of its stadium at every height; one that goes straight
    // up or down sweeps a cylinder.
    const bool is_cylinder = shape.core == ConvexShape::Core::cone && shape.margin == 0.0
                             && shape.cone.r0 == shape.cone.r1;
    const bool level = from.z == to.z, upright = from.x == to.x && from.y == to.y;
    result.exact = result.straight && is_cylinder && (level || upright);
    return result;
}

double distance_bound(const ShapeOutline& shape, const Aabb& box, double limit) {
    const double by_boxes = distance(shape.box, box);
    if (!shape.straight || by_boxes >= limit) return by_boxes;
    const double above = std::max({box.min.z - shape.box.max.z, shape.box.min.z - box.max.z, 0.0});
    const double across = std::max(0.0, path_to_rectangle(shape, box) - shape.radius);
    return std::max(by_boxes, std::sqrt(squared(across, above)));
}

} // namespace core

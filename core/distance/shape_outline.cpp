#include "core/distance/shape_outline.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/math.h"

namespace core {
namespace {

/// The upright cylinder around points, about the axis through the origin.
ProfileElement cylinder_round(std::span<const Vec3> points, double margin) {
    ProfileElement element{.z0 = infinity, .z1 = -infinity, .margin = margin};
    for (const Vec3& point : points) {
        element.r0 = std::max(element.r0, core::hypot(point.x, point.y));
        element.z0 = std::min(element.z0, point.z);
        element.z1 = std::max(element.z1, point.z);
    }
    element.r1 = element.r0;
    return element;
}

void add_slab(ShapeOutline& outline, const ConvexShape& shape, const Vec3& direction) {
    const double length = glm::length(direction);
    if (!(length > 0.0)) return;
    const Vec3 normal = direction / length;
    outline.slabs[outline.slab_count++] = {
        normal, glm::dot(normal, support(shape, -normal).point) - shape.margin,
        glm::dot(normal, support(shape, normal).point) + shape.margin};
}

/// Slabs along the edges of a path of three or four places, seen from above, and one in the plane
/// of the first three.
void add_slabs(ShapeOutline& outline, const ConvexShape& shape) {
    const size_t count = shape.position_count;
    if (count < 3 || count > 4) return;
    const auto edge = [&](size_t from, size_t to) {
        return shape.positions[to].at - shape.positions[from].at;
    };
    for (size_t i = 0; i < count; ++i)
        for (size_t j = i + 1; j < count; ++j)
            add_slab(outline, shape, glm::cross(edge(i, j), Vec3(0.0, 0.0, 1.0)));
    add_slab(outline, shape, glm::cross(edge(0, 1), edge(0, 2)));
}

/// A lower bound of the distance of a box from what is between the planes.
double distance_bound(const ShapeOutline::Slab& slab, const Aabb& box) {
    const double middle = glm::dot(slab.normal, box.center());
    const double half = 0.5 * glm::dot(glm::abs(slab.normal), box.size());
    return std::max(slab.low - (middle + half), (middle - half) - slab.high);
}

/// Slabs along the edges of a hull of points from its first point, as those of a box.
void add_edge_slabs(ShapeOutline& outline, const ConvexShape& shape) {
    if (shape.point_count != 8) return;
    for (const size_t other : {1, 2, 4})
        if (outline.slab_count < ShapeOutline::max_slabs)
            add_slab(outline, shape, shape.points[other] - shape.points[0]);
}

/// The point of a truncated cone nearest to a point, both in the frame of the cone; the point
/// itself if it is inside.
Vec3 nearest_point(const ProfileElement& cone, const Vec3& point) {
    const double r = std::sqrt(point.x * point.x + point.y * point.y), height = cone.z1 - cone.z0;
    const double up = std::clamp(point.z, cone.z0, cone.z1);
    const double radius =
        height > 0.0 ? cone.r0 + (cone.r1 - cone.r0) / height * (up - cone.z0) : cone.r0;
    double near_r = r, near_z = up;
    if (r > radius) {
        // The wall, or a rim: the foot of the perpendicular on the generating line.
        const double wide = cone.r1 - cone.r0, length = wide * wide + height * height;
        const double along = (r - cone.r0) * wide + (point.z - cone.z0) * height;
        const double t = length > 0.0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
        near_r = cone.r0 + t * wide, near_z = cone.z0 + t * height;
    }
    const double scale = r > 0.0 ? near_r / r : 0.0;
    return {point.x * scale, point.y * scale, near_z};
}

/// A lower bound of the distance of a tilted piece on its straight way from a box, without its
/// margin: by the plane at right angles to a pair of points that are nearly nearest.
///
/// Any plane gives a valid bound, so the points need not be.
double distance_of_tilted(const ShapeOutline& shape, const Aabb& box, double limit) {
    const UprightSweep& sweep = shape.sweep;
    const Mat3& axes = shape.orientation;
    const ProfileElement& cone = sweep.element;
    const Vec3 middle = box.center(), half = 0.5 * box.size();
    const double way = glm::dot(sweep.by, sweep.by);
    double time = 0.5, best = 0.0;
    Vec3 there = middle;
    constexpr int rounds = 4;
    for (int i = 0; i < rounds; ++i) {
        const Vec3 here = sweep.from + time * sweep.by;
        const Vec3 on_piece = here + axes * nearest_point(cone, (there - here) * axes);
        there = glm::clamp(on_piece, box.min, box.max);
        const Vec3 apart = there - on_piece;
        const double distance = glm::length(apart);
        if (!(distance > 0.0)) return best;
        const Vec3 normal = apart / distance;
        const Vec3 local = normal * axes;
        const double across = std::sqrt(local.x * local.x + local.y * local.y);
        const double piece =
            std::max(cone.r0 * across + cone.z0 * local.z, cone.r1 * across + cone.z1 * local.z)
            + std::max(0.0, glm::dot(normal, sweep.by)) + glm::dot(normal, sweep.from);
        const double gap = glm::dot(normal, middle) - glm::dot(glm::abs(normal), half) - piece;
        best = std::max(best, gap);
        constexpr double close = 0.02; // of the distance: what is left is not worth another round
        if (best >= limit || distance - best <= close * distance) return best;
        if (way > 0.0) time = std::clamp(time + glm::dot(apart, sweep.by) / way, 0.0, 1.0);
    }
    return best;
}

/// A frame with this direction as its Z.
Mat3 frame_along(const Vec3& z) {
    const Vec3 other = std::abs(z.x) < 0.5 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
    const Vec3 x = glm::normalize(glm::cross(other, z));
    return {x, glm::cross(z, x), z};
}

/// A ball, or the sweep of one along a segment, as a piece about that segment.
void use_segment(ShapeOutline& outline, const ConvexShape& shape) {
    const Vec3 along = shape.points[shape.point_count - 1U] - shape.points[0];
    const double length = glm::length(along);
    outline.sweep.element = {.z1 = length, .margin = shape.margin};
    outline.sweep.from += shape.points[0];
    if (length > 0.0) outline.orientation = frame_along(along / length);
}

} // namespace

ShapeOutline outline(const ConvexShape& shape) {
    ShapeOutline result{.box = bounds(shape)};
    const bool is_cone = shape.core == ConvexShape::Core::cone;
    result.straight = shape.position_count <= 2 && shape.upright;
    result.tilted =
        shape.position_count <= 2 && !shape.upright && (is_cone || shape.point_count <= 2);
    if (!result.straight && !result.tilted) {
        add_slabs(result, shape);
        if (!shape.upright) add_edge_slabs(result, shape);
        return result;
    }
    result.sweep.from = shape.positions[0].at;
    result.sweep.by = shape.positions[shape.position_count - 1U].at - shape.positions[0].at;
    result.exact = result.straight && is_cone;
    if (is_cone) {
        result.sweep.element = shape.cone;
        result.orientation = shape.orientation;
    } else if (result.straight) {
        result.sweep.element =
            cylinder_round({shape.points.data(), shape.point_count}, shape.margin);
    } else {
        use_segment(result, shape);
    }
    result.sweep.element.margin = shape.margin;
    return result;
}

double distance_bound(const ShapeOutline& shape, const Aabb& box, double limit) {
    double by_boxes = distance(shape.box, box);
    for (size_t i = 0; i < shape.slab_count && by_boxes < limit; ++i)
        by_boxes = std::max(by_boxes, distance_bound(shape.slabs[i], box));
    if (by_boxes >= limit) return by_boxes;
    if (shape.straight) return std::max(by_boxes, distance_bound(shape.sweep, box, limit));
    if (!shape.tilted) return by_boxes;
    const double margin = shape.sweep.element.margin;
    return std::max(by_boxes, distance_of_tilted(shape, box, limit + margin) - margin);
}

} // namespace core

#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/transform.h"
#include "core/geom/mesh.h"
#include "core/geom/profile.h"

namespace core {

/// A convex body known by its support function: a hull of up to eight points or a truncated cone,
/// grown by `margin` all round, and swept over the hull of its `places`.
///
/// A place is where the body's own origin stands, and when; the hull of two places is a straight
/// motion, the hull of eight a box in which nobody knows the path.
struct ConvexShape {
    enum class Core : uint8_t { points, cone };
    struct Place {
        Vec3 at = Vec3(0.0);
        double time = 0.0; // 0..1 of the motion
    };
    static constexpr size_t max_points = 8;
    static constexpr size_t max_places = 9;

    Core core = Core::points;
    uint8_t point_count = 0;
    uint8_t place_count = 1;
    std::array<Vec3, max_points> points{}; // when core is points
    ProfileElement cone;                   // when core is cone: axis along the local Z
    Mat3 orientation = Mat3(1.0);          // of the cone
    bool upright = true;                   // orientation is the identity
    double margin = 0.0;
    std::array<Place, max_places> places{};
};

ConvexShape convex(const Triangle& triangle);
ConvexShape convex(const Aabb& box);
ConvexShape convex_segment(const Vec3& a, const Vec3& b);
ConvexShape convex(const ProfileElement& element);
ConvexShape convex_sphere(double radius);

/// The shape rotated about its origin, then moved. It must stand at a single place.
ConvexShape posed(const ConvexShape& shape, const Transform& target_from_shape);

/// The shape moved over the hull of `places`; times are spread evenly, 0 at the first, 1 at the
/// last.
ConvexShape swept(const ConvexShape& shape, std::span<const Vec3> places);

/// A point of the shape that lies farthest along a direction, without the margin.
struct SupportPoint {
    Vec3 point;
    double time;
};
SupportPoint support(const ConvexShape& shape, const Vec3& direction);

/// The box round the shape with its margin and its sweep.
Aabb bounds(const ConvexShape& shape);

} // namespace core

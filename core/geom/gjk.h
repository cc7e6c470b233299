#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/vec.h"
#include "core/geom/profile.h"

namespace core {

struct Triangle;

/// A convex body given by its support function: a hull of up to eight points or a truncated cone,
/// grown by `margin` on all sides and swept over the hull of its `positions`.
///
/// A place is a position of the body's origin with a time. The hull of two places is a straight
/// motion, the hull of eight a box within which the path is unknown.
struct ConvexShape {
    enum class Core : uint8_t { points, cone };
    struct Position {
        Vec3 at = Vec3(0.0);
        double time = 0.0; // 0..1 of the motion
    };
    static constexpr size_t max_points = 8;
    static constexpr size_t max_positions = 9;

    Core core = Core::points;
    uint8_t point_count = 0;
    uint8_t position_count = 1;
    std::array<Vec3, max_points> points{}; // when core is points
    ProfileElement cone;                   // when core is cone: axis along the local Z
    Mat3 orientation = Mat3(1.0);          // of the cone
    bool upright = true;                   // orientation is the identity
    double margin = 0.0;
    std::array<Position, max_positions> positions{};
};

ConvexShape convex(const Triangle& triangle);
ConvexShape convex(const Aabb& box);
ConvexShape convex_segment(const Vec3& a, const Vec3& b);
ConvexShape convex(const ProfileElement& element);
ConvexShape convex_sphere(double radius);

/// The shape rotated about its origin, then translated. It must have a single place.
ConvexShape posed(const ConvexShape& shape, const Transform& target_from_shape);

/// The shape moved over the hull of `positions`; times are spread evenly from 0 at the first to 1
/// at the last.
ConvexShape swept(const ConvexShape& shape, std::span<const Vec3> positions);

/// The displacements that a body may have: all points of a segment. The default is none at all.
struct Play {
    Vec3 from = Vec3(0.0), to = Vec3(0.0);

    bool none() const { return from == Vec3(0.0) && to == Vec3(0.0); }
    Vec3 least() const { return glm::min(from, to); }
    Vec3 most() const { return glm::max(from, to); }

    bool operator==(const Play&) const = default;
};

/// The segment seen from another frame.
inline Play rotated(const Mat3& target_from_frame, const Play& play) {
    return {target_from_frame * play.from, target_from_frame * play.to};
}

/// The box that contains a box under all displacements.
inline Aabb displaced(const Aabb& box, const Play& play) {
    return {box.min + play.least(), box.max + play.most()};
}

/// The farthest point of the shape in a direction, without the margin.
struct SupportPoint {
    Vec3 point;
    double time;
};
SupportPoint support(const ConvexShape& shape, const Vec3& direction);

/// The box of the shape including its margin and its sweep.
Aabb bounds(const ConvexShape& shape);

/// The distance between two bodies: lower <= true distance <= upper, and the points that give
/// `upper`.
struct Separation {
    double lower = infinity;
    double upper = infinity;
    Vec3 point_a = Vec3(0.0), point_b = Vec3(0.0); // on A and on B; equal when they overlap
    double time_a = 0.0;                           // time in A's sweep, 0..1

    bool found() const { return upper < infinity; }
};

/// When a search for the distance of two convex shapes may end.
struct SeparationGoal {
    double tolerance = 1e-7;   // mm: ends when upper - lower is at most this
    double limit = infinity;   // mm: ends when lower reaches this; upper need not be tight then
    double enough = -infinity; // mm: ends when upper is below this; lower need not be tight then
};

/// The distance between two convex shapes.
///
/// Result:  both bounds hold whenever the search ends: `lower` comes from a separating plane,
///          `upper` from a pair of points, each recomputed from the support functions. 0 if the
///          shapes overlap. Rounding is below 1e-9 mm for coordinates within 2 m and is not
///          subtracted here.
/// Cost:    about 3-20 support evaluations for each shape; 1-3 if `limit` decides. Source:
/// Gilbert, Johnson, Keerthi 1988; sub-distances as in Ericson, Real-Time Collision
///          Detection, 5.1.
Separation separation(const ConvexShape& a, const ConvexShape& b, const SeparationGoal& goal = {});

/// One to four points of the Minkowski difference A - B and the points they come from.
struct Simplex {
    struct Vertex {
        Vec3 difference; // on_a - on_b
        Vec3 on_a, on_b;
        double time_a;
        double weight; // barycentric coordinate of the point nearest to the origin
    };
    std::array<Vertex, 4> vertices;
    int count = 0;
};

/// Keeps the vertices whose hull contains the point nearest to the origin and sets their weights.
///
/// Result:  that point; the origin itself if the simplex is a tetrahedron around it.
Vec3 reduce_to_nearest(Simplex& simplex);

} // namespace core

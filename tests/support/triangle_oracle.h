#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/vec.h"
#include "core/geom/mesh.h"

namespace test_support {

/// Eleven more bits than in the code under test, so that its rounding is visible.
using Wide = glm::tvec3<long double>;

struct WideTriangle {
    std::array<Wide, 3> corners;
};

inline WideTriangle wide(const core::Triangle& t) { return {{Wide(t.a), Wide(t.b), Wide(t.c)}}; }

/// Transformed exactly by the numbers of the transform, even if they are not quite a rotation.
inline WideTriangle wide(const core::Triangle& t, const core::Transform& by) {
    const glm::tmat3x3<long double> rotation(by.rotation);
    WideTriangle moved = wide(t);
    for (Wide& p : moved.corners) p = rotation * p + Wide(by.translation);
    return moved;
}

inline long double clamp_wide(long double x) { return std::clamp(x, 0.0L, 1.0L); }

inline long double point_to_segment(const Wide& p, const Wide& a, const Wide& b) {
    const Wide along = b - a;
    const long double square = glm::dot(along, along);
    const long double s = square > 0 ? clamp_wide(glm::dot(p - a, along) / square) : 0.0L;
    return glm::length(a + s * along - p);
}

/// Both ends against the other segment, and the point where the lines pass each other if it is on
/// both.
inline long double segment_to_segment(const Wide& a, const Wide& b, const Wide& c, const Wide& d) {
    long double least = std::min({point_to_segment(a, c, d), point_to_segment(b, c, d),
                                  point_to_segment(c, a, b), point_to_segment(d, a, b)});
    const Wide u = b - a, v = d - c, normal = glm::cross(u, v);
    const long double square = glm::dot(normal, normal);
    if (!(square > 0)) return least;
    const long double s = glm::dot(glm::cross(c - a, v), normal) / square;
    const long double t = glm::dot(glm::cross(c - a, u), normal) / square;
    if (s > 0 && s < 1 && t > 0 && t < 1)
        least = std::min(least, glm::length(a + s * u - c - t * v));
    return least;
}

/// The distance to the foot of the point on the face, calculated as a mean of the corners so that
/// it is a point of the triangle however thin that is; infinite if the foot is outside.
inline long double point_to_face(const Wide& p, const WideTriangle& t) {
    const Wide &a = t.corners[0], &b = t.corners[1], &c = t.corners[2];
    const Wide normal = glm::cross(b - a, c - a);
    const long double u = glm::dot(glm::cross(c - b, p - b), normal);
    const long double v = glm::dot(glm::cross(a - c, p - c), normal);
    const long double w = glm::dot(glm::cross(b - a, p - a), normal);
    if (!(std::min({u, v, w}) >= 0) || !(u + v + w > 0))
        return std::numeric_limits<long double>::infinity();
    return glm::length((u * a + v * b + w * c) / (u + v + w) - p);
}

/// For the start of the segment, and for the point where it passes the plane of the face.
inline long double segment_to_face(const Wide& a, const Wide& b, const WideTriangle& t) {
    const Wide& origin = t.corners[0];
    const Wide normal = glm::cross(t.corners[1] - origin, t.corners[2] - origin);
    const long double from = glm::dot(a - origin, normal), to = glm::dot(b - origin, normal);
    long double least = point_to_face(a, t);
    if (from * to < 0)
        least = std::min(least, point_to_face(a + (from / (from - to)) * (b - a), t));
    return least;
}

/// The distance of two triangles: each corner to a face, each edge to each edge, each edge through
/// a face.
inline long double wide_distance(const WideTriangle& a, const WideTriangle& b) {
    long double least = std::numeric_limits<long double>::infinity();
    for (size_t i = 0; i < 3; ++i) {
        const Wide &a0 = a.corners[i], &a1 = a.corners[(i + 1) % 3];
        const Wide &b0 = b.corners[i], &b1 = b.corners[(i + 1) % 3];
        least = std::min({least, segment_to_face(a0, a1, b), segment_to_face(b0, b1, a)});
        for (size_t j = 0; j < 3; ++j)
            least =
                std::min(least, segment_to_segment(a0, a1, b.corners[j], b.corners[(j + 1) % 3]));
    }
    return least;
}

/// A lower bound of the distance of all pairs of points.
inline long double ball_gap(const WideTriangle& a, const WideTriangle& b) {
    const auto middle = [](const WideTriangle& t) {
        return (t.corners[0] + t.corners[1] + t.corners[2]) / 3.0L;
    };
    const auto radius = [&](const WideTriangle& t) {
        long double most = 0;
        for (const Wide& p : t.corners) most = std::max(most, glm::length(p - middle(t)));
        return most;
    };
    return glm::length(middle(b) - middle(a)) - radius(a) - radius(b);
}

/// Every triangle against every triangle.
inline long double wide_distance(const core::Mesh& a, const core::Mesh& b,
                                 const core::Transform& a_from_b) {
    long double least = std::numeric_limits<long double>::infinity();
    for (size_t j = 0; j < b.triangles.size(); ++j) {
        const WideTriangle moved = wide(b.triangle(j), a_from_b);
        for (size_t i = 0; i < a.triangles.size(); ++i) {
            const WideTriangle fixed = wide(a.triangle(i));
            if (ball_gap(fixed, moved) < least)
                least = std::min(least, wide_distance(fixed, moved));
        }
    }
    return least;
}

} // namespace test_support

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "core/base/vec.h"

namespace test_support {

/// True distances in closed form, with a 64-bit mantissa, independent of the program.
using Real = long double;
using RealVec = glm::vec<3, Real>;
using RealMat = glm::mat<3, 3, Real>;

constexpr Real real_infinity = std::numeric_limits<Real>::infinity();

/// All points within `radius` of a segment; a ball when its ends coincide.
struct TrueCapsule {
    RealVec a, b;
    Real radius;
};
/// A box along the axes of the body's frame.
struct TrueBox {
    RealVec min, max;
};
/// A cylinder round the Z axis of the body's frame.
struct TrueCylinder {
    Real z0, z1, radius;
};
/// A torus about Z: radius of the ring and of the tube.
struct TrueTorus {
    Real ring, tube;
};
using TruePart = std::variant<TrueCapsule, TrueBox, TrueCylinder, TrueTorus>;

/// The pose of a part: p -> turn * p + at.
struct RealPose {
    RealMat turn = RealMat(1);
    RealVec at = RealVec(0);

    RealVec operator*(const RealVec& p) const { return turn * p + at; }
    RealVec back(const RealVec& p) const { return glm::inverse(turn) * (p - at); }
};

inline RealPose exactly(const core::Transform& t) {
    return {RealMat(t.rotation), RealVec(t.translation)};
}

inline Real point_to_segment(const RealVec& p, const RealVec& a, const RealVec& b) {
    const RealVec ab = b - a;
    const Real length = glm::dot(ab, ab);
    const Real t = length > 0 ? std::clamp<Real>(glm::dot(p - a, ab) / length, 0, 1) : 0;
    return glm::length(p - a - t * ab);
}

/// The least of the distances of the ends and of the common perpendicular: each of them is an
/// existing distance.
inline Real segment_to_segment(const RealVec& a, const RealVec& b, const RealVec& c,
                               const RealVec& d) {
    Real least = std::min({point_to_segment(a, c, d), point_to_segment(b, c, d),
                           point_to_segment(c, a, b), point_to_segment(d, a, b)});
    const RealVec u = b - a, v = d - c, w = a - c;
    const Real uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v);
    const Real uw = glm::dot(u, w), vw = glm::dot(v, w), det = uu * vv - uv * uv;
    if (!(det > 0)) return least;
    const Real s = std::clamp<Real>((uv * vw - vv * uw) / det, 0, 1);
    const Real t = std::clamp<Real>((uu * vw - uv * uw) / det, 0, 1);
    return std::min(least, glm::length(w + s * u - t * v));
}

/// The distance of a point from a part; negative only inside round parts.
inline Real point_to(const TrueCapsule& c, const RealVec& p) {
    return point_to_segment(p, c.a, c.b) - c.radius;
}
inline Real point_to(const TrueBox& b, const RealVec& p) {
    return glm::length(glm::max(glm::max(b.min - p, p - b.max), RealVec(0)));
}
inline Real point_to(const TrueCylinder& c, const RealVec& p) {
    const Real across = std::max<Real>(0, std::hypot(p.x, p.y) - c.radius);
    return std::hypot(across, std::max<Real>({c.z0 - p.z, p.z - c.z1, 0}));
}
inline Real point_to(const TrueTorus& t, const RealVec& p) {
    return std::hypot(std::hypot(p.x, p.y) - t.ring, p.z) - t.tube;
}
inline Real point_to(const TruePart& part, const RealVec& p) {
    return std::visit([&](const auto& shape) { return point_to(shape, p); }, part);
}

inline std::array<RealVec, 8> corners(const TrueBox& b, const RealPose& pose) {
    std::array<RealVec, 8> all;
    for (int i = 0; i < 8; ++i)
        all[static_cast<size_t>(i)] =
            pose
            * RealVec(i & 1 ? b.max.x : b.min.x, i & 2 ? b.max.y : b.min.y,
                      i & 4 ? b.max.z : b.min.z);
    return all;
}

/// The 12 edges of a box as pairs of corner numbers.
inline const std::array<std::array<size_t, 2>, 12> box_edges = {{{0, 1},
                                                                 {2, 3},
                                                                 {4, 5},
                                                                 {6, 7},
                                                                 {0, 2},
                                                                 {1, 3},
                                                                 {4, 6},
                                                                 {5, 7},
                                                                 {0, 4},
                                                                 {1, 5},
                                                                 {2, 6},
                                                                 {3, 7}}};

/// Whether a segment intersects a box.
inline bool meets(const TrueBox& box, const RealVec& a, const RealVec& b) {
    Real first = 0, last = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const Real by = b[axis] - a[axis];
        Real in = (box.min[axis] - a[axis]) / by, out = (box.max[axis] - a[axis]) / by;
        if (by == 0) {
            if (a[axis] < box.min[axis] || a[axis] > box.max[axis]) return false;
            continue;
        }
        if (in > out) std::swap(in, out);
        first = std::max(first, in);
        last = std::min(last, out);
    }
    return first <= last;
}

inline Real segment_to(const TrueBox& box, const RealVec& a, const RealVec& b) {
    if (meets(box, a, b)) return 0;
    const auto corner = corners(box, {});
    Real least = std::min(point_to(box, a), point_to(box, b));
    for (const auto& [i, j] : box_edges)
        least = std::min(least, segment_to_segment(a, b, corner[i], corner[j]));
    return least;
}

/// The least value on a segment of a function that is convex on it.
template <typename Function>
Real least_on_segment(const Function& f, const RealVec& a, const RealVec& b) {
    const auto at = [&](Real t) { return f(a + t * (b - a)); };
    Real low = 0, high = 1;
    for (int i = 0; i < 90; ++i) {
        const Real s = low + (high - low) * Real(0.38), t = low + (high - low) * Real(0.62);
        if (at(s) <= at(t))
            high = t;
        else
            low = s;
    }
    return std::min({at(0), at(1), at(low)});
}

inline Real segment_to(const TrueCylinder& c, const RealVec& a, const RealVec& b) {
    if (a == b) return point_to(c, a);
    return least_on_segment([&](const RealVec& p) { return point_to(c, p); }, a, b);
}
inline Real segment_to(const TrueCapsule& c, const RealVec& a, const RealVec& b) {
    return segment_to_segment(a, b, c.a, c.b) - c.radius;
}

} // namespace test_support

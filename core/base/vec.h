#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/glm.hpp>

namespace core {

using Vec3 = glm::dvec3;
using Mat3 = glm::dmat3;

constexpr double infinity = std::numeric_limits<double>::infinity();

inline bool is_finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// An axis-aligned box; empty (min above max) until something is added.
struct Aabb {
    Vec3 min = Vec3(+infinity);
    Vec3 max = Vec3(-infinity);

    void extend(const Vec3& p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
    void extend(const Aabb& b) {
        min = glm::min(min, b.min);
        max = glm::max(max, b.max);
    }
    bool empty() const { return min.x > max.x || min.y > max.y || min.z > max.z; }
    Vec3 center() const { return 0.5 * (min + max); }
    Vec3 size() const { return max - min; }
    /// An upper bound of the distance of any point of the box from the origin.
    double reach() const { return glm::length(glm::max(glm::abs(min), glm::abs(max))); }
    Aabb grown(double by) const { return {min - Vec3(by), max + Vec3(by)}; }
};

/// Whether the closed boxes share a point.
inline bool overlaps(const Aabb& a, const Aabb& b) {
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y
           && a.min.z <= b.max.z && b.min.z <= a.max.z;
}

/// Squared distance from `p` to the nearest point of `box`; 0 inside.
inline double distance_squared(const Vec3& p, const Aabb& box) {
    const Vec3 outside = glm::max(glm::max(box.min - p, p - box.max), Vec3(0.0));
    return glm::dot(outside, outside);
}

/// Distance between the nearest points of two boxes; 0 when they overlap.
inline double distance(const Aabb& a, const Aabb& b) {
    const Vec3 gap = glm::max(glm::max(a.min - b.max, b.min - a.max), Vec3(0.0));
    return glm::length(gap);
}

/// A rigid transform. Name it `target_from_source`, so that compositions can be checked by reading:
/// `p_machine = machine_from_stock * p_stock`.
struct Transform {
    Mat3 rotation = Mat3(1.0);
    Vec3 translation = Vec3(0.0);

    Vec3 operator*(const Vec3& p) const { return rotation * p + translation; }

    Transform operator*(const Transform& b) const {
        return {rotation * b.rotation, rotation * b.translation + translation};
    }

    Transform inverse() const {
        const Mat3 back = glm::transpose(rotation);
        return {back, -(back * translation)};
    }

    bool operator==(const Transform&) const = default;
};

inline Transform translation(const Vec3& by) { return {Mat3(1.0), by}; }

/// How far a matrix is from a rotation: the largest entry of |R^T R - 1|. A vector grows by at most
/// 1.5 times this, relative to its length. NaN if any entry is NaN.
double distortion(const Mat3& rotation);

/// Rotation about the fixed axes X, then Y, then Z. Multiples of 90 degrees are exact.
Mat3 rotation_xyz_deg(const Vec3& angles_deg);

/// The angles from which rotation_xyz_deg makes this rotation again, within 1e-10 in each entry.
///
/// Result:  in -180..180, with as few decimals as the rotation allows, and with zeros where there
///          is a choice: (0, 120, 0) rather than (180, 60, 180). If X and Z turn about the same
///          line (Y is 90 or -90), X is 0.
Vec3 angles_xyz_deg(const Mat3& rotation);

} // namespace core

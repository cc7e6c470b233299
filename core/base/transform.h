#pragma once

#include <glm/glm.hpp>

#include "core/base/vec.h"

namespace core {

using Mat3 = glm::dmat3;

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

/// How far a matrix is from a rotation: the largest entry of R^T R - 1, so that no vector becomes
/// longer than by 1.5 times this share; not a number if any entry is none.
double distortion(const Mat3& rotation);

/// Rotation about X, then Y, then Z, fixed axes. Multiples of 90 degrees are exact.
Mat3 rotation_xyz_deg(const Vec3& angles_deg);

} // namespace core

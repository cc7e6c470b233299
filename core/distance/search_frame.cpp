#include "core/distance/search_frame.h"

namespace core {
namespace {

/// The part of `v` at right angles to the unit vector `u`, of unit length; zero if hardly any.
Vec3 beside(const Vec3& v, const Vec3& u) {
    const double length = glm::length(v);
    if (!(length > 0.0)) return Vec3(0.0);
    const Vec3 part = v / length - glm::dot(v / length, u) * u;
    return glm::length(part) > 1e-3 ? glm::normalize(part) : Vec3(0.0);
}

/// Some direction at right angles to `u`.
Vec3 any_beside(const Vec3& u) {
    const Vec3 a = glm::abs(u);
    const int least = a.x <= a.y && a.x <= a.z ? 0 : a.y <= a.z ? 1 : 2;
    Vec3 axis(0.0);
    axis[least] = 1.0;
    return beside(axis, u);
}

} // namespace

SearchFrame search_frame(const Vec3& across, const Vec3& along, const Vec3& origin,
                         const Vec3& sweep) {
    const double length = glm::length(across);
    const Vec3 u = length > 0.0 ? across / length : Vec3(1.0, 0.0, 0.0);
    Vec3 v = beside(sweep, u);
    if (v == Vec3(0.0)) v = beside(along, u);
    if (v == Vec3(0.0)) v = any_beside(u);
    return {{u, v, glm::cross(u, v)}, origin};
}

} // namespace core

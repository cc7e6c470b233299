#include "core/geom/placement.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"
#include "core/geom/mesh.h"

namespace core {
namespace {

constexpr double rounding_of_entries = 1e-12;
constexpr double nearly_opposite = 1e-6;

/// Without components that are only rounding.
Vec3 tidied_direction(const Vec3& direction) {
    Vec3 result = glm::normalize(direction);
    for (int k = 0; k < 3; ++k)
        if (std::abs(result[k]) <= rounding_of_entries) result[k] = 0.0;
    return glm::normalize(result);
}

/// The first of Z, X, Y at right angles to a direction, or else a horizontal direction.
Vec3 axis_across(const Vec3& direction) {
    for (const int k : {2, 0, 1}) {
        if (direction[k] != 0.0) continue;
        Vec3 axis(0.0);
        axis[k] = 1.0;
        return axis;
    }
    return glm::normalize(glm::cross(direction, Vec3(0.0, 0.0, 1.0)));
}

/// Three directions at right angles: `a`, the part of `b` across it, and their product.
Mat3 frame_of(const Vec3& a, const Vec3& b) {
    const Vec3 across = glm::normalize(b - glm::dot(a, b) * a);
    return {a, across, glm::cross(a, across)};
}

} // namespace

Mat3 tidied(const Mat3& rotation) {
    Mat3 whole;
    bool exact = true;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            whole[i][j] = core::round(rotation[i][j]) + 0.0; // no -0
            exact &= std::abs(rotation[i][j] - whole[i][j]) <= rounding_of_entries;
        }
    if (exact) return whole;
    // One step of Newton's iteration towards the nearest rotation.
    return rotation * (Mat3(1.5) - 0.5 * (glm::transpose(rotation) * rotation));
}

Mat3 least_rotation(const Vec3& from, const Vec3& to) {
    const Vec3 a = tidied_direction(from), b = tidied_direction(to);
    if (glm::distance(a, b) <= rounding_of_entries) return Mat3(1.0);
    const bool opposite = glm::length(a + b) <= nearly_opposite;
    const Vec3 axis = opposite ? axis_across(a) : glm::normalize(glm::cross(a, b));
    // Both frames have the axis in common but for rounding, which so does not reach `a` and `b`.
    return tidied(frame_of(b, axis) * glm::transpose(frame_of(a, axis)));
}

Transform face_to_face(const FacePlane& moving, const FacePlane& fixed, const Transform& pose,
                       const FaceFit& fit) {
    const Vec3 wanted = fit.flush ? fixed.normal : -fixed.normal;
    const Mat3 turn = least_rotation(pose.rotation * moving.normal, wanted);
    const Vec3 point = pose * moving.point;
    const double way = glm::dot(fixed.point - point, fixed.normal) + fit.offset;
    const Vec3 shift =
        fit.centred ? fixed.point + fit.offset * fixed.normal - point : way * fixed.normal;
    if (turn == Mat3(1.0)) return {pose.rotation, pose.translation + shift};
    const Mat3 rotation = tidied(turn * pose.rotation);
    return {rotation, point + shift - rotation * moving.point};
}

BodyExtent extent_along(const Mesh& mesh, const Transform& pose, const Vec3& direction) {
    const Vec3 in_mesh = direction * pose.rotation;
    BodyExtent extent;
    for (const Mesh::Corners& t : mesh.triangles)
        for (const uint32_t v : t) {
            const double along = glm::dot(mesh.vertices[v], in_mesh);
            extent.from = std::min(extent.from, along);
            extent.to = std::max(extent.to, along);
        }
    const double origin = glm::dot(pose.translation, direction);
    return {extent.from + origin, extent.to + origin};
}

Vec3 centred_between(const BodyExtent& body, const Vec3& direction, const FacePlane& a,
                     const FacePlane& b) {
    const double middle = 0.5 * (glm::dot(a.point, direction) + glm::dot(b.point, direction));
    return (middle - 0.5 * (body.from + body.to)) * direction;
}

} // namespace core

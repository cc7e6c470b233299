#include "core/geom/rigid_motion.h"

#include "core/base/units.h"

namespace core {
namespace {

/// The matrix that makes the cross product with `v`.
Mat3 cross_with(const Vec3& v) { return Mat3(0.0, v.z, -v.y, -v.z, 0.0, v.x, v.y, -v.x, 0.0); }

/// Rodrigues' formula; 1 - cos by the half angle, so that small turns keep their digits.
Mat3 rotation_about(const Vec3& axis, double angle) {
    const SinCos half = sin_cos(0.5 * angle);
    const Mat3 k = cross_with(axis);
    return Mat3(1.0) + 2.0 * half.sin * half.cos * k + 2.0 * half.sin * half.sin * (k * k);
}

/// The axis of a turn of more than a right angle, from (R + R^T) / 2 = c + (1 - c) a a^T, of which
/// the column with the largest diagonal is best.
Vec3 axis_of_large_turn(const Mat3& r, double cosine) {
    const Mat3 part = 0.5 * (r + glm::transpose(r)) - Mat3(cosine);
    const Vec3 diagonal(part[0][0], part[1][1], part[2][2]);
    const int most = diagonal.x >= diagonal.y && diagonal.x >= diagonal.z ? 0
                     : diagonal.y >= diagonal.z                           ? 1
                                                                          : 2;
    return glm::normalize(part[most]);
}

} // namespace

Transform RigidMotion::at(double time) const {
    if (time <= 0.0) return start;
    if (time >= 1.0) return end;
    return turned_to(time);
}

Transform RigidMotion::turned_to(double time) const {
    const Mat3 turned = rotation_about(axis, time * angle) * start.rotation;
    const Vec3 from = start * centre;
    const Vec3 place = from + time * (end * centre - from);
    return {turned, place - turned * centre};
}

RigidMotion motion_between(const Transform& start, const Transform& end, const Vec3& centre) {
    RigidMotion motion{.start = start, .end = end, .centre = centre};
    const Mat3 turn = end.rotation * glm::transpose(start.rotation);
    const Vec3 twice_sine(turn[1][2] - turn[2][1], turn[2][0] - turn[0][2],
                          turn[0][1] - turn[1][0]);
    const double sine = 0.5 * glm::length(twice_sine);
    const double cosine = 0.5 * (turn[0][0] + turn[1][1] + turn[2][2] - 1.0);
    motion.angle = angle_of(sine, cosine);
    if (cosine < 0.0) {
        motion.axis = axis_of_large_turn(turn, cosine);
        if (glm::dot(motion.axis, twice_sine) < 0.0) motion.axis = -motion.axis;
    } else if (sine > 0.0) {
        motion.axis = glm::normalize(twice_sine);
    }
    return motion;
}

RigidMotion turning_motion(const Transform& start, const Vec3& centre, const Vec3& axis,
                           double angle, const Vec3& travel) {
    const Vec3 unit = glm::normalize(axis);
    const Mat3 turned = rotation_about(unit, angle) * start.rotation;
    const Vec3 place = start * centre + travel;
    return {start, {turned, place - turned * centre}, centre, unit, angle};
}

// The lengths below are convex over the box, so that a corner has the largest.

double displacement(const Transform& from, const Transform& to, const Aabb& box) {
    const Mat3 turn = to.rotation - from.rotation;
    const Vec3 middle = turn * box.center() + (to.translation - from.translation);
    const Vec3 half = 0.5 * box.size();
    const Vec3 x = half.x * turn[0], y = half.y * turn[1], z = half.z * turn[2];
    double most = 0.0;
    for (const Vec3& corner : {x + y + z, x + y - z, x - y + z, x - y - z})
        for (const Vec3& way : {middle + corner, middle - corner})
            most = std::max(most, glm::dot(way, way));
    return std::sqrt(most);
}

double gap_at_end(const RigidMotion& motion, const Aabb& box) {
    return displacement(motion.turned_to(1.0), motion.end, box);
}

double reach_from_axis(const RigidMotion& motion, const Aabb& box) {
    const Vec3 axis_in_b = glm::transpose(motion.start.rotation) * motion.axis;
    double reach = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p((corner & 1 ? box.max : box.min).x, (corner & 2 ? box.max : box.min).y,
                     (corner & 4 ? box.max : box.min).z);
        reach = std::max(reach, glm::length(glm::cross(axis_in_b, p - motion.centre)));
    }
    return reach;
}

} // namespace core

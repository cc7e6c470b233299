#pragma once

#include "core/base/vec.h"

namespace core {

/// How a body B moves past A in the time 0..1: one point of it goes straight, and the body turns
/// about that point evenly. Rotary axes of a machine, a spindle, and any way from one pose to
/// another are of this kind.
struct RigidMotion {
    Transform start, end;      // a_from_b at the times 0 and 1
    Vec3 centre = Vec3(0.0);   // the point that goes straight, in B's frame
    Vec3 axis = Vec3(0, 0, 1); // of length 1, in A's frame
    double angle = 0.0;        // radians in all; may be several turns

    /// The pose at a time 0..1; at 0 and 1 start and end themselves.
    Transform at(double time) const;

    /// The pose that the turn leads to at a time, which at 0 and 1 is not to the last bit that of
    /// start and end.
    Transform turned_to(double time) const;

    /// How far `centre` goes. Frame: A's.
    Vec3 travel() const { return end * centre - start * centre; }
};

/// The motion from one pose to another by the least turn; of two equal ones, half a turn, either.
RigidMotion motion_between(const Transform& start, const Transform& end,
                           const Vec3& centre = Vec3(0.0));

/// The motion that turns by `angle` (radians, any number of turns) about an axis through `centre`
/// (B's frame), which goes on by `travel`. `axis` (A's frame) need not have length 1.
RigidMotion turning_motion(const Transform& start, const Vec3& centre, const Vec3& axis,
                           double angle, const Vec3& travel = Vec3(0.0));

/// The largest distance between where two poses put a point of the box (B's frame).
double displacement(const Transform& from, const Transform& to, const Aabb& box);

/// The largest distance, over the box (B's frame), between where the turn leads and `end`: rounding
/// and what the poses are off rotations, or more if the parts of the motion do not go together.
double gap_at_end(const RigidMotion& motion, const Aabb& box);

/// The largest distance of a point of the box (B's frame) from the line that B turns about.
double reach_from_axis(const RigidMotion& motion, const Aabb& box);

/// How far, while the motion goes on for a `share` of the time, a point `reach` from the axis can
/// be from the place it would have if it went straight: the error of a chord, at most a half of
/// the square of half the time times the acceleration.
inline double bulge(const RigidMotion& motion, double reach, double share) {
    const double turn = motion.angle * share;
    return 0.125 * turn * turn * reach;
}

/// How far a point `reach` from the axis can be, in that share of the time, from where it would be
/// had the body kept the orientation it has half way.
inline double swing(const RigidMotion& motion, double reach, double share) {
    return 0.5 * std::abs(motion.angle) * share * reach;
}

} // namespace core

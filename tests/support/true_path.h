#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/vec.h"
#include "core/motion/event.h"
#include "tests/support/true_profile.h"

namespace test_support {

/// X, Y and Z move the tool; A tilts the carrier of table C, each about a line through a point.
struct TrueTrunnion {
    core::Vec3 a_point = core::Vec3(0.0), c_point = core::Vec3(0.0);
};

inline core::Vec3 turned_about_x(const core::Vec3& p, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
}
inline core::Vec3 turned_about_z(const core::Vec3& p, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

constexpr double true_radian = std::numbers::pi / 180.0;

/// A body on the table or on the machine base.
struct TrueMount {
    core::Transform link_from_body;
    bool on_table = true;
};

/// The position in the machine of a mounted point.
inline core::Vec3 machine_position(const TrueTrunnion& machine, const TrueMount& mount,
                                   const core::AxisValues& at, const core::Vec3& p) {
    core::Vec3 here = mount.link_from_body * p;
    if (!mount.on_table) return here;
    if (at[5] != 0.0)
        here = turned_about_z(here - machine.c_point, -at[5] * true_radian) + machine.c_point;
    if (at[3] != 0.0)
        here = turned_about_x(here - machine.a_point, -at[3] * true_radian) + machine.a_point;
    return here;
}

inline core::Vec3 mounted_place(const TrueTrunnion& machine, const TrueMount& mount,
                                const core::AxisValues& at, core::Vec3 p) {
    if (mount.on_table) {
        p = turned_about_x(p - machine.a_point, at[3] * true_radian) + machine.a_point;
        p = turned_about_z(p - machine.c_point, at[5] * true_radian) + machine.c_point;
    }
    return mount.link_from_body.inverse() * p;
}

/// A path of the machine: all axes linearly, or an arc.
struct TruePath {
    core::AxisValues from{}, to{};
    std::optional<core::ArcPath> arc = {};

    bool turns() const { return from[3] != to[3] || from[5] != to[5]; }
    bool is_straight() const { return !arc && !turns(); }

    core::AxisValues at(double fraction) const {
        core::AxisValues values = from;
        for (size_t i = 0; i < core::axis_count; ++i) values[i] += fraction * (to[i] - from[i]);
        if (!arc) return values;
        const int a = (arc->normal + 1) % 3, b = (arc->normal + 2) % 3;
        const double u = from[size_t(a)] - arc->centre[a], v = from[size_t(b)] - arc->centre[b];
        const double c = std::cos(fraction * arc->angle), s = std::sin(fraction * arc->angle);
        values[size_t(a)] = arc->centre[a] + c * u - s * v;
        values[size_t(b)] = arc->centre[b] + s * u + c * v;
        return values;
    }

    /// The total change of direction of the path, radians.
    double bend() const {
        if (arc) return std::abs(arc->angle);
        return (std::abs(to[3] - from[3]) + std::abs(to[5] - from[5])) * true_radian;
    }

    /// The distance of a point from the axes about which it rotates; the radius of the arc.
    double bend_radius(const TrueTrunnion& machine, const core::Vec3& p_table) const {
        if (!arc)
            return glm::distance(p_table, machine.c_point)
                   + glm::distance(machine.c_point, machine.a_point);
        const int a = (arc->normal + 1) % 3, b = (arc->normal + 2) % 3;
        return std::hypot(from[size_t(a)] - arc->centre[a], from[size_t(b)] - arc->centre[b]);
    }
};

/// The path of a mounted point relative to a tool.
///
/// Between two fractions it stays within `off` of the chord: an eighth of the squared time times
/// the acceleration, which is the squared angle times the radius.
struct SeenPoint {
    const TrueTrunnion& machine;
    const TrueMount& mount;
    const TruePath& path;
    double tool_length;
    core::Vec3 p;

    core::Vec3 operator()(double fraction) const {
        const core::AxisValues at = path.at(fraction);
        return machine_position(machine, mount, at, p)
               - core::Vec3(at[0], at[1], at[2] - tool_length);
    }
    double off(double fraction) const {
        const double turn = path.bend() * fraction;
        if (turn == 0.0) return 0.0;
        const core::Vec3 p_table = mount.link_from_body * p;
        return 0.125 * turn * turn * path.bend_radius(machine, p_table);
    }
};

} // namespace test_support

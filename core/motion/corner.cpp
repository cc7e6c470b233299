#include "core/motion/corner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/math.h"
#include "core/motion/machine.h"

namespace core {
namespace {

bool has_ends(const Leg& leg) { return leg.straight && leg.positions.size() == 2; }

/// The change of the linear axes over a leg.
AxisValues travel_of(const Leg& leg) {
    AxisValues travel{};
    for (size_t i = 0; i < axis_count; ++i)
        if (!is_rotary(i)) travel[i] = leg.positions.back()[i] - leg.positions.front()[i];
    return travel;
}

double dot(const AxisValues& a, const AxisValues& b) {
    double sum = 0.0;
    for (size_t i = 0; i < axis_count; ++i) sum += a[i] * b[i];
    return sum;
}

/// The length of a leg in the linear axes; for a box of possible positions, its diagonal.
double length_of(const Leg& leg) {
    if (has_ends(leg)) return std::sqrt(dot(travel_of(leg), travel_of(leg)));
    double longest = 0.0;
    for (const AxisValues& position : leg.positions) {
        double squared = 0.0;
        for (size_t i = 0; i < axis_count; ++i)
            if (!is_rotary(i))
                squared +=
                    (position[i] - leg.positions[0][i]) * (position[i] - leg.positions[0][i]);
        longest = std::max(longest, std::sqrt(squared));
    }
    return longest;
}

bool turns(const Leg& leg) {
    for (const AxisValues& position : leg.positions)
        for (size_t i = 0; i < axis_count; ++i)
            if (is_rotary(i) && position[i] != leg.positions[0][i]) return true;
    return false;
}

/// The change of direction between two straight legs, radians; empty if a direction is unknown.
std::optional<double> turn_between(const Leg& before, const Leg& after) {
    if (!has_ends(before) || !has_ends(after)) return std::nullopt;
    const AxisValues from = travel_of(before), to = travel_of(after);
    const double lengths = std::sqrt(dot(from, from) * dot(to, to));
    if (!(lengths > 0.0)) return std::nullopt;
    return core::acos(std::clamp(dot(from, to) / lengths, -1.0, 1.0));
}

/// Appends the legs within `reach` of the start of a path, or of its end; a leg with unknown
/// directions is taken as a whole.
void append_within(std::span<const Leg> legs, double reach, bool at_end, std::vector<Leg>& along) {
    for (size_t n = 0; n < legs.size() && reach > 0.0; ++n) {
        const Leg& leg = at_end ? legs[legs.size() - 1 - n] : legs[n];
        const double length = length_of(leg);
        const double share = length > reach ? reach / length : 1.0;
        if (!has_ends(leg) || share >= 1.0)
            along.push_back(leg);
        else
            along.push_back(at_end ? stretch(leg, 1.0 - share, 1.0) : stretch(leg, 0.0, share));
        reach -= length;
    }
}

Leg hull_of(const std::vector<Leg>& legs) {
    Leg hull{.begin = legs.front().begin, .end = legs.front().begin, .straight = false};
    for (const Leg& leg : legs) {
        hull.path_error = std::max(hull.path_error, leg.path_error);
        hull.turn_error = std::max(hull.turn_error, leg.turn_error);
        for (const AxisValues& position : leg.positions)
            if (std::find(hull.positions.begin(), hull.positions.end(), position)
                == hull.positions.end())
                hull.positions.push_back(position);
    }
    return hull;
}

} // namespace

double length_of(std::span<const Leg> legs) {
    double length = 0.0;
    for (const Leg& leg : legs) length += length_of(leg);
    return length;
}

bool states_dynamics(const Machine& machine) {
    for (size_t i = 0; i < axis_count; ++i) {
        const MachineAxis& axis = machine.axes[i];
        if (axis.present && !is_rotary(i) && !(axis.rapid && axis.acceleration)) return false;
    }
    return true;
}

double rounding_reach(double deviation, double turn) {
    return 4.0 * deviation / core::sin(0.5 * turn);
}

namespace {

// LinuxCNC 2.9, src/emc/tp: tc.c, tp.c and blendmath.c.
constexpr double cycle = 1.05;          // how far the planner moves in a servo cycle
constexpr double least_share = 0.45;    // of the acceleration for a motion that is blended
constexpr double share_along_arc = 0.5; // of that, along an arc
constexpr double least_angle = 1e-3;    // radians: below this, the tolerance limits nothing
constexpr double feed_override = 1.2;

/// A motion at its end at a corner.
struct CornerSide {
    AxisValues heading{}; // of the linear axes; length 1
    double radius = infinity;
    std::optional<size_t> plane_normal = {}; // of an arc
};

/// The greatest speed on legs, mm/s.
double speed_on(std::span<const Leg> legs) {
    double speed = 0.0;
    for (const Leg& leg : legs)
        if (leg.end > leg.begin) speed = std::max(speed, length_of(leg) / (leg.end - leg.begin));
    return speed;
}

/// The direction of an arc at a fraction of its angle, and its least radius.
void set_heading(CornerSide& side, const Motion& motion, double fraction) {
    const ArcPath& arc = *motion.arc;
    const auto n = static_cast<size_t>(arc.normal), u = (n + 1) % 3, v = (n + 2) % 3;
    const auto part = [&](const AxisPosition& at, size_t axis) {
        return *at[axis] - arc.centre[static_cast<int>(axis)];
    };
    const double before = core::hypot(part(motion.from, u), part(motion.from, v)),
                 after = core::hypot(part(motion.to, u), part(motion.to, v));
    side.radius = std::min(before, after);
    side.plane_normal = n;
    const double turned = fraction * arc.angle;
    const double cosine = core::cos(turned), sine = core::sin(turned);
    const double out_u = (cosine * part(motion.from, u) - sine * part(motion.from, v)) / before,
                 out_v = (sine * part(motion.from, u) + cosine * part(motion.from, v)) / before;
    const double around = arc.angle * (before + fraction * (after - before));
    side.heading[u] = -around * out_v + (after - before) * out_u;
    side.heading[v] = around * out_u + (after - before) * out_v;
    side.heading[n] = *motion.to[n] - *motion.from[n];
}

/// Empty if the direction there is not known.
std::optional<CornerSide> side_of(std::span<const Leg> legs, bool at_end) {
    if (legs.empty()) return std::nullopt;
    const Leg& leg = at_end ? legs.back() : legs.front();
    if (!has_ends(leg)) return std::nullopt;
    CornerSide side;
    if (leg.arc.motion)
        set_heading(side, *leg.arc.motion, at_end ? leg.arc.last : leg.arc.first);
    else
        side.heading = travel_of(leg);
    const double size = std::sqrt(dot(side.heading, side.heading));
    if (!(size > 0.0)) return std::nullopt;
    for (double& part : side.heading) part /= size;
    return side;
}

double turn_between(const CornerSide& before, const CornerSide& after) {
    return core::acos(std::clamp(dot(before.heading, after.heading), -1.0, 1.0));
}

/// The least and the greatest acceleration along a motion beside a corner, mm/s2, of a machine that
/// states those of its axes. While a motion is blended, LinuxCNC takes half of it, and less beside
/// smooth corners.
struct Accelerations {
    double least = infinity, most = infinity;
};

Accelerations accelerations_of(const CornerSide& side, const Machine& machine) {
    Accelerations along;
    if (side.plane_normal) { // those of the axes, whatever the direction
        along.most = 0.0;
        for (size_t i = 0; i < 3; ++i) {
            if (i == *side.plane_normal && side.heading[i] == 0.0) continue;
            const double axis = machine.axes[i].acceleration.value_or(infinity);
            along.least = std::min(along.least, axis);
            along.most = std::max(along.most, axis);
        }
        return {share_along_arc * least_share * along.least, along.most};
    }
    for (size_t i = 0; i < axis_count; ++i)
        if (side.heading[i] != 0.0 && machine.axes[i].acceleration)
            along.most =
                std::min(along.most, *machine.axes[i].acceleration / std::abs(side.heading[i]));
    return {least_share * along.most, along.most};
}

/// The farthest from a corner between straight motions at which their blend is, as a multiple of
/// where it begins to brake, both times the sine of half the angle by which the path turns. It
/// brakes with a along the first motion and accelerates with `ratio` times a along the second one.
double blend_share(double ratio) {
    if (ratio == infinity) return 2.0;
    const double root = std::sqrt(ratio);
    return 2.0 * ratio / ((1.0 + root) * (1.0 + root));
}

} // namespace

std::optional<double> turn_at(std::span<const Leg> before, std::span<const Leg> after) {
    const auto first = side_of(before, true), second = side_of(after, false);
    if (!first || !second) return std::nullopt;
    return turn_between(*first, *second);
}

double most_blend_deviation(const Machine& machine) {
    double least = infinity, square = 0.0;
    for (size_t i = 0; i < axis_count; ++i) {
        const MachineAxis& axis = machine.axes[i];
        if (!axis.present || is_rotary(i) || !axis.acceleration) continue;
        least = std::min(least, *axis.acceleration);
        square += *axis.acceleration * *axis.acceleration;
    }
    const double ratio = states_dynamics(machine) && least > 0.0
                             ? std::sqrt(square) / (least_share * least)
                             : infinity;
    // It begins to brake 2 T / sin(turn / 2) before the corner.
    return cycle * 2.0 * blend_share(ratio);
}

CornerBlend blend_at(std::span<const Leg> before, std::span<const Leg> after, double tolerance,
                     bool is_feed, const Machine& machine) {
    CornerBlend blend{{0.5 * length_of(before), length_of(after)}};
    blend.deviation = std::min(blend.reach.before, blend.reach.after);
    const auto first = side_of(before, true), second = side_of(after, false);
    if (!first || !second) return blend;
    const double half = 0.5 * turn_between(*first, *second);
    const double most_override = is_feed ? feed_override : 1.0;
    const double v1 = most_override * speed_on(before), v2 = most_override * speed_on(after);
    const Accelerations of_second = accelerations_of(*second, machine);
    const bool is_known = states_dynamics(machine);
    double lean = 0.0; // of the direction that LinuxCNC takes for an arc after the corner
    if (second->plane_normal)
        lean = is_known
                   ? core::atan2(v2 * v2, 4.0 * second->radius * of_second.least / share_along_arc)
                   : std::numbers::pi;
    const double seen = half - 0.5 * lean - least_angle;
    double& d = blend.reach.before;
    double& e = blend.reach.after;
    const double to_middle = std::min(d, 0.5 * e);
    if (seen > 0.0) d = std::min(d, cycle * 2.0 * tolerance / core::sin(seen));
    if (!is_known) {
        if (!first->plane_normal && !second->plane_normal && tolerance < infinity)
            blend.deviation =
                std::min(blend.deviation, cycle * 2.0 * blend_share(infinity) * tolerance);
        return blend;
    }
    const double a1 = accelerations_of(*first, machine).least, a2 = of_second.most;
    d = std::min(d, cycle * v1 * v1 / (2.0 * a1));
    const double braking = std::sqrt(2.0 * d / a1); // seconds
    e = std::min(e, cycle
                        * (braking * a2 < v2 ? 0.5 * a2 * braking * braking
                                             : v2 * braking - 0.5 * v2 * v2 / a2));
    const double bends = a2 / a1 * d * d / 16.0 * (1.0 / first->radius + 1.0 / second->radius);
    double deviation = blend_share(a2 / a1) * d * core::sin(half) + bends;
    // Or it inserts a circle, with the acceleration of the slowest axis.
    double least = infinity;
    for (size_t i = 0; i < axis_count; ++i)
        if (machine.axes[i].present && !is_rotary(i))
            least = std::min(least, *machine.axes[i].acceleration);
    const double speed = std::max(v1, v2);
    const double of_turn =
        half > 0.0 ? std::max(2.0 / std::numbers::sqrt3, cycle / half) * core::tan(half) : cycle;
    double circle = std::min(to_middle, speed * speed / least * of_turn);
    if (half > 0.0) circle = std::min(circle, 2.0 * tolerance / core::sin(half));
    d = std::max(d, circle);
    e = std::max(e, circle);
    deviation = std::max(deviation, circle * core::tan(0.5 * half));
    blend.deviation = std::min({blend.deviation, deviation, d, e});
    return blend;
}

std::optional<CornerRegion> corner_region(std::span<const Leg> before, std::span<const Leg> after,
                                          double deviation, const CornerReach& reach) {
    constexpr double straight_on = 1e-6; // radians: the rounding stays within 1e-6 of the length
    if (!(deviation > 0.0) || before.empty() || after.empty()) return std::nullopt;
    const double length_before = length_of(before), length_after = length_of(after);
    if (!(length_before > 0.0 && length_after > 0.0)) return std::nullopt;
    const std::optional<double> turn = turn_between(before.back(), after.front());
    if (turn && *turn < straight_on) return std::nullopt;
    const double most = turn ? rounding_reach(deviation, *turn) : infinity;
    const auto reach_on = [&](double length, double stated) {
        return stated < infinity ? std::min(stated, length) : std::min(most, 0.5 * length);
    };
    CornerRegion region;
    append_within(before, reach_on(length_before, reach.before), true, region.along);
    std::reverse(region.along.begin(), region.along.end());
    append_within(after, reach_on(length_after, reach.after), false, region.along);
    if (std::none_of(region.along.begin(), region.along.end(), turns))
        region.hull = hull_of(region.along);
    return region;
}

} // namespace core

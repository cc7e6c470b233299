#include "core/motion/corner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/math.h"
#include "core/base/units.h"
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

namespace {

// LinuxCNC: 1e-8 mm or inches.
constexpr double counted = 1e-6; // mm, degrees

} // namespace

bool is_left_out(const Motion& motion) {
    if (motion.arc) return false;
    for (size_t i = 0; i < axis_count; ++i) {
        if (motion.from[i].has_value() != motion.to[i].has_value()) return false;
        if (motion.from[i] && std::abs(*motion.to[i] - *motion.from[i]) > counted) return false;
    }
    return true;
}

std::vector<Leg> without_rounding(std::span<const Leg> legs) {
    std::vector<Leg> plain(legs.begin(), legs.end());
    for (Leg& leg : plain) {
        if (!has_ends(leg)) continue;
        for (size_t i = 0; i < axis_count; ++i)
            if (std::abs(leg.positions[1][i] - leg.positions[0][i]) <= counted)
                leg.positions[1][i] = leg.positions[0][i];
    }
    return plain;
}

double length_of(std::span<const Leg> legs) {
    double length = 0.0;
    for (const Leg& leg : legs) length += length_of(leg);
    return length;
}

// LinuxCNC 2.9, emccanon.cc: ARC_FEED, chord_deviation.
std::vector<Leg> lines_of_arc(const Motion& motion, const Path& path, double joining) {
    if (!(joining > 0.0) || !motion.arc || motion.arc->normal != 2 || path.legs.empty()) return {};
    constexpr double rounding = 1.0 + 1e-9;
    const ArcPath& arc = *motion.arc;
    const AxisValues &from = path.legs.front().positions.front(),
                     &to = path.legs.back().positions.back();
    const double radius = core::hypot(from[0] - arc.centre.x, from[1] - arc.centre.y);
    if (std::abs(arc.angle) > 2.0 * std::numbers::pi * rounding
        || radius * (1.0 - core::cos(0.5 * arc.angle)) > joining * rounding)
        return {};
    AxisValues middle = from;
    for (size_t i = 0; i < axis_count; ++i) middle[i] = 0.5 * (from[i] + to[i]);
    const double cosine = core::cos(0.5 * arc.angle), sine = core::sin(0.5 * arc.angle);
    const double x = from[0] - arc.centre.x, y = from[1] - arc.centre.y;
    middle[0] = arc.centre.x + cosine * x - sine * y;
    middle[1] = arc.centre.y + sine * x + cosine * y;
    const double half = 0.5 * path.duration;
    return {{.positions = {from, middle}, .begin = 0.0, .end = half},
            {.positions = {middle, to}, .begin = half, .end = path.duration}};
}

bool states_accelerations(const Machine& machine) {
    for (size_t i = 0; i < axis_count; ++i)
        if (machine.axes[i].present && !is_rotary(i) && !machine.axes[i].acceleration) return false;
    return true;
}

bool states_dynamics(const Machine& machine) {
    for (size_t i = 0; i < axis_count; ++i)
        if (machine.axes[i].present && !is_rotary(i) && !machine.axes[i].rapid) return false;
    return states_accelerations(machine);
}

bool states_all_dynamics(const Machine& machine) {
    return std::all_of(machine.axes.begin(), machine.axes.end(), [](const MachineAxis& axis) {
        return !axis.present || (axis.rapid && axis.acceleration);
    });
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
    AxisValues heading{};  // of the linear axes; length 1
    Vec3 seen = Vec3(0.0); // the direction that LinuxCNC takes, but for the lean of arcs
    double radius = infinity;
    std::optional<size_t> plane_normal = {}; // of an arc
    bool rises = false;                      // of an arc: it is a helix

    bool is_arc() const { return plane_normal.has_value(); }
};

/// The greatest speed on legs, mm/s; infinity if it is not known.
double speed_on(std::span<const Leg> legs) {
    double speed = 0.0;
    for (const Leg& leg : legs)
        if (leg.end > leg.begin) speed = std::max(speed, length_of(leg) / (leg.end - leg.begin));
    return speed > 0.0 ? speed : infinity;
}

/// The directions of an arc at a fraction of its angle, and its least radius. LinuxCNC leaves out
/// how it rises, and how its radius changes.
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
    side.rises = side.heading[n] != 0.0;
    side.seen[static_cast<int>(u)] = arc.angle > 0.0 ? -out_v : out_v;
    side.seen[static_cast<int>(v)] = arc.angle > 0.0 ? out_u : -out_u;
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
    if (!side.is_arc()) side.seen = Vec3(side.heading[0], side.heading[1], side.heading[2]);
    return side;
}

double angle_between(double cosine) { return core::acos(std::clamp(cosine, -1.0, 1.0)); }

double turn_between(const CornerSide& before, const CornerSide& after) {
    return angle_between(dot(before.heading, after.heading));
}

/// The angle between the direction of an arc and the one that LinuxCNC takes for it.
double slope_of(const CornerSide& side) {
    return angle_between(side.heading[0] * side.seen.x + side.heading[1] * side.seen.y
                         + side.heading[2] * side.seen.z);
}

/// The least and the greatest acceleration along a motion beside a corner, mm/s2, of a machine that
/// states those of its axes. While a motion is blended, LinuxCNC takes half of it, and less beside
/// smooth corners.
struct Accelerations {
    double least = infinity, most = infinity;
};

Accelerations accelerations_of(const CornerSide& side, const Machine& machine) {
    Accelerations along;
    if (side.is_arc()) { // those of the axes, whatever the direction
        constexpr double of_helix = std::numbers::sqrt2;
        along.most = 0.0;
        for (size_t i = 0; i < 3; ++i) {
            if (i == *side.plane_normal && !side.rises) continue;
            const double axis = machine.axes[i].acceleration.value_or(infinity);
            along.least = std::min(along.least, axis);
            along.most = std::max(along.most, axis);
        }
        return {share_along_arc * least_share * along.least,
                (side.rises ? of_helix : 1.0) * along.most};
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

/// The acceleration of the slowest linear axis, mm/s2, of a machine that states all.
double least_acceleration(const Machine& machine) {
    double least = infinity;
    for (size_t i = 0; i < axis_count; ++i)
        if (machine.axes[i].present && !is_rotary(i))
            least = std::min(least, *machine.axes[i].acceleration);
    return least;
}

/// The greatest acceleration of any direction of the linear axes, mm/s2, likewise.
double greatest_acceleration(const Machine& machine) {
    double square = 0.0;
    for (size_t i = 0; i < axis_count; ++i)
        if (machine.axes[i].present && !is_rotary(i))
            square += *machine.axes[i].acceleration * *machine.axes[i].acceleration;
    return std::sqrt(square);
}

/// The blend of a machine that states its dynamics, in X, Y and Z.
class KnownBlend {
public:
    KnownBlend(const CornerSide& first, const CornerSide& second, double tolerance,
               const std::array<double, 2>& speeds, const Machine& machine)
        : first_(first),
          second_(second),
          tolerance_(tolerance),
          v1_(speeds[0]),
          v2_(speeds[1]),
          a1_(accelerations_of(first, machine).least),
          a2_(accelerations_of(second, machine).most),
          slowest_(least_acceleration(machine)),
          strongest_(greatest_acceleration(machine)) {
        // Of an arc after the corner, LinuxCNC takes a direction that leans to its centre.
        if (second.is_arc())
            lean_ =
                core::atan2(v2_ * v2_, 4.0 * second.radius * accelerations_of(second, machine).least
                                           / share_along_arc);
    }

    /// `middle`, `end`: the lengths of half of the first motion and of the second one, mm.
    CornerBlend at_known_turn(double middle, double end) const {
        const double half = 0.5 * turn_between(first_, second_);
        const double seen =
            0.5 * (angle_between(glm::dot(first_.seen, second_.seen)) - lean_) - least_angle;
        double d = middle;
        if (seen > 0.0) d = std::min(d, cycle * 2.0 * tolerance_ / core::sin(seen));
        CornerBlend blend = from(d, end);
        blend.deviation += blend_share(a2_ / a1_) * blend.reach.before * core::sin(half);
        // Or it inserts a circle, with the acceleration of the slowest axis.
        const double speed = std::max(v1_, v2_);
        const double of_turn =
            half > 0.0 ? std::max(2.0 / std::numbers::sqrt3, cycle / half) * core::tan(half)
                       : cycle;
        double circle = std::min({middle, 0.5 * end, speed * speed / slowest_ * of_turn});
        if (half > 0.0) circle = std::min(circle, 2.0 * tolerance_ / core::sin(half));
        blend.reach = {std::max(blend.reach.before, circle), std::max(blend.reach.after, circle)};
        blend.deviation = std::max(blend.deviation, circle * core::tan(0.5 * half));
        return blend;
    }

    /// Whatever the turn. Circles reach farther, within the tolerance.
    CornerBlend at_any_turn(double middle, double end) const {
        KnownBlend any = *this;
        any.a1_ = std::min(a1_, least_share * slowest_);
        any.a2_ = std::max(a2_, strongest_);
        return any.at_turn_of_joined(middle, end);
    }

private:
    CornerBlend at_turn_of_joined(double middle, double end) const {
        CornerBlend blend = from(middle, end);
        const double unseen = 0.5 * (lean_ + slope_of(first_) + slope_of(second_)) + least_angle;
        blend.deviation +=
            blend_share(a2_ / a1_)
            * (cycle * 2.0 * tolerance_
               + blend.reach.before * core::sin(std::min(unseen, 0.5 * std::numbers::pi)));
        blend.deviation = std::max(blend.deviation, tolerance_); // of circles
        return blend;
    }

    /// The reach of a blend that begins to brake `most` before the corner at the earliest, and how
    /// far the curves of arcs are from their tangents.
    CornerBlend from(double most, double end) const {
        const double d = std::min(most, cycle * v1_ * v1_ / (2.0 * a1_));
        const double braking = std::sqrt(2.0 * d / a1_); // seconds
        const double way = braking * a2_ < v2_ ? 0.5 * a2_ * braking * braking
                                               : v2_ * braking - 0.5 * v2_ * v2_ / a2_;
        return {{d, std::min(end, cycle * way)},
                a2_ / a1_ * d * d / 16.0 * (1.0 / first_.radius + 1.0 / second_.radius)};
    }

    const CornerSide &first_, &second_;
    double tolerance_, v1_, v2_, a1_, a2_, slowest_, strongest_, lean_ = 0.0;
};

/// A straight motion of any axes, for one millimetre in X, Y and Z.
struct Rates {
    AxisValues rates{};
    double speed = infinity; // in X, Y and Z, mm/s
};

std::optional<Rates> rates_of(const Leg& leg) {
    if (!has_ends(leg) || leg.arc.motion) return std::nullopt;
    Rates motion;
    const AxisValues &from = leg.positions.front(), &to = leg.positions.back();
    const double length =
        core::hypot(core::hypot(to[0] - from[0], to[1] - from[1]), to[2] - from[2]);
    if (!(length > 0.0)) return std::nullopt;
    for (size_t i = 0; i < axis_count; ++i) motion.rates[i] = (to[i] - from[i]) / length;
    if (leg.end > leg.begin) motion.speed = length / (leg.end - leg.begin);
    return motion;
}

/// The least acceleration along a straight motion that is blended, mm/s2; 0 if an axis that it
/// moves does not state it.
double least_along(const Rates& motion, const Machine& machine) {
    double least = infinity;
    for (size_t i = 0; i < axis_count; ++i) {
        if (motion.rates[i] == 0.0) continue;
        if (!machine.axes[i].acceleration) return 0.0;
        least = std::min(least, *machine.axes[i].acceleration / std::abs(motion.rates[i]));
    }
    return least_share * least;
}

/// The least acceleration of an axis in a motion that is blended, mm/s2; empty if it is not stated.
/// Along an arc it is that of the slowest axis.
std::optional<double> blended_acceleration(std::span<const Leg> legs, size_t axis,
                                           const Machine& machine) {
    std::optional<double> own = machine.axes[axis].acceleration;
    if (!legs.back().arc.motion) {
        if (own) *own *= least_share;
        return own;
    }
    for (size_t i = 0; i < axis_count && own; ++i) {
        if (!machine.axes[i].present || is_rotary(i) != is_rotary(axis)) continue;
        if (!machine.axes[i].acceleration) return std::nullopt;
        own = std::min(*own, *machine.axes[i].acceleration);
    }
    if (own) *own *= share_along_arc * least_share;
    return own;
}

/// The part of a motion that is left when it begins to brake: at most half, and what a cycle adds.
double share_left(std::span<const Leg> legs, double most_override, const Machine& machine) {
    constexpr double most = 0.5 * cycle;
    if (legs.empty() || !has_ends(legs.back())) return most;
    const Leg& leg = legs.back();
    const double time = (leg.end - leg.begin) / most_override;
    double total = 0.0, left = 0.0;
    for (const Leg& one : legs) total += (one.end - one.begin) / most_override;
    // Lines that it is joined with have no times here.
    if (length_of(leg) > 0.0) total = std::max(total, time * length_of(legs) / length_of(leg));
    for (size_t i = 0; i < axis_count; ++i) {
        double way = std::abs(leg.positions.back()[i] - leg.positions.front()[i]);
        if (leg.arc.motion && way > 0.0 && !is_rotary(i)) way = length_of(leg);
        const double rate = way / time;
        if (way == 0.0) continue;
        const std::optional<double> acceleration = blended_acceleration(legs, i, machine);
        if (!acceleration || !(time > 0.0)) return most;
        // Of its way, rate times the time, it needs rate^2 / (2 a).
        left = std::max(left, cycle * rate / (2.0 * *acceleration) / total);
    }
    return std::min(left, most);
}

/// The time that a motion needs at most for the part that is left when it brakes, seconds.
double time_of_rest(std::span<const Leg> legs, double left, const Machine& machine) {
    AxisValues ways{};
    for (const Leg& leg : legs)
        for (size_t i = 0; i < axis_count && !leg.positions.empty(); ++i)
            ways[i] += std::abs(leg.positions.back()[i] - leg.positions.front()[i]);
    double square = 0.0;
    for (size_t i = 0; i < axis_count; ++i) {
        if (ways[i] == 0.0) continue;
        if (legs.back().arc.motion && !is_rotary(i)) ways[i] = core::length_of(legs);
        const std::optional<double> acceleration = blended_acceleration(legs, i, machine);
        if (!acceleration) return infinity;
        square = std::max(square, 2.0 * left * ways[i] / *acceleration);
    }
    return cycle * std::sqrt(square);
}

/// The blend of motions of which one moves other axes than X, Y and Z.
CornerBlend blend_of_others(std::span<const Leg> before, std::span<const Leg> after,
                            double tolerance, bool rapid, const Machine& machine) {
    const double most_override = rapid ? 1.0 : feed_override;
    // The times of rapids on axes without a stated speed are only assumed.
    const bool has_speeds = !rapid || states_all_dynamics(machine);
    const double middle = 0.5 * length_of(before), end = length_of(after);
    const auto first = before.empty() ? std::nullopt : rates_of(before.back()),
               second = after.empty() ? std::nullopt : rates_of(after.front());
    CornerBlend blend{{middle, end}};
    blend.left = 0.5 * cycle;
    if (!first || !second) {
        // Some of the first motion is left when the second one begins, so its path is that far off.
        if (has_speeds) blend.left = share_left(before, most_override, machine);
        blend.deviation = blend.left * 2.0 * middle;
        blend.turn = blend.left * turned_on(before);
    } else {
        // It brakes with half of the acceleration from which its speed was computed.
        constexpr double longer = 2.0;
        double cosine = 0.0, square = 0.0, degrees = 0.0;
        for (size_t i = 0; i < axis_count; ++i) {
            const double change = std::abs(second->rates[i] - first->rates[i]);
            if (i < 3) cosine += first->rates[i] * second->rates[i];
            if (is_rotary(i))
                degrees += change;
            else
                square += change * change;
        }
        const double half = 0.5 * angle_between(cosine);
        double rest = cycle * middle; // of the first motion when the second one begins
        if (half > least_angle)
            rest = std::min(rest, longer * cycle * 2.0 * tolerance / core::sin(half - least_angle));
        const double least = least_along(*first, machine), speed = most_override * first->speed;
        if (least > 0.0 && has_speeds) rest = std::min(rest, cycle * speed * speed / (2.0 * least));
        const double both = std::min(rest, end); // that is made at the same time
        blend.deviation = std::sqrt(square) * both;
        blend.turn = degrees / degrees_per_radian * both;
        if (middle > 0.0) blend.left = rest / (2.0 * middle);
    }
    const double time = after.empty() ? 0.0 : (after.back().end - after.front().begin);
    if (time > 0.0 && has_speeds)
        blend.part_after = most_override * time_of_rest(before, blend.left, machine) / time;
    return blend;
}

} // namespace

bool moves_other_axes(std::span<const Leg> legs) {
    return std::any_of(legs.begin(), legs.end(), [](const Leg& leg) {
        for (const AxisValues& position : leg.positions)
            if (!std::equal(position.begin() + 3, position.end(),
                            leg.positions.front().begin() + 3))
                return true;
        return false;
    });
}

double turned_on(std::span<const Leg> legs) {
    double degrees = 0.0;
    for (const Leg& leg : legs)
        for (size_t i = 0; i < axis_count; ++i)
            if (is_rotary(i) && !leg.positions.empty())
                degrees += std::abs(leg.positions.back()[i] - leg.positions.front()[i]);
    return degrees / degrees_per_radian;
}

std::vector<Leg> last_part(std::span<const Leg> legs, double part) {
    const bool has_times =
        std::all_of(legs.begin(), legs.end(), [](const Leg& leg) { return leg.end > leg.begin; });
    const auto size_of = [&](const Leg& leg) {
        return has_times ? leg.end - leg.begin : length_of(leg);
    };
    double left = 0.0;
    for (const Leg& leg : legs) left += part * size_of(leg);
    std::vector<Leg> last;
    for (size_t n = legs.size(); n > 0 && left > 0.0; --n) {
        const Leg& leg = legs[n - 1];
        const double size = size_of(leg);
        last.push_back(size > left ? stretch(leg, 1.0 - left / size, 1.0) : leg);
        left -= size;
    }
    if (last.empty()) last.assign(legs.rbegin(), legs.rend()); // neither times nor lengths
    std::reverse(last.begin(), last.end());
    for (Leg& leg : last) leg.arc = {};
    return last;
}

std::vector<Leg> displaced(std::span<const Leg> legs, const Leg& rest, double from, double to,
                           const AxisValues& corner) {
    const AxisValues &first = rest.positions.front(), &last = rest.positions.back();
    AxisValues by{};
    for (size_t i = 0; i < axis_count; ++i)
        by[i] = first[i] + 0.5 * (from + to) * (last[i] - first[i]) - corner[i];
    const double half = 0.5 * (to - from), off = half * length_of(rest) + rest.path_error,
                 turn = half * turned_on({&rest, 1}) + rest.turn_error;
    std::vector<Leg> all(legs.begin(), legs.end());
    for (Leg& leg : all) {
        for (AxisValues& position : leg.positions)
            for (size_t i = 0; i < axis_count; ++i) position[i] += by[i];
        leg.path_error += off;
        leg.lasting_error += off;
        leg.turn_error += turn;
        leg.arc = {};
    }
    return all;
}

std::optional<double> turn_at(std::span<const Leg> before, std::span<const Leg> after) {
    const auto first = side_of(before, true), second = side_of(after, false);
    if (!first || !second) return std::nullopt;
    return turn_between(*first, *second);
}

double most_reach_of_speed(const Machine& machine) {
    if (!states_accelerations(machine)) return 0.0;
    return cycle * feed_override * feed_override
           / (2.0 * share_along_arc * least_share * least_acceleration(machine));
}

double most_blend_deviation(const Machine& machine) {
    const double ratio =
        states_accelerations(machine)
            ? greatest_acceleration(machine) / (least_share * least_acceleration(machine))
            : infinity;
    // It begins to brake 2 T / sin(turn / 2) before the corner.
    return cycle * 2.0 * blend_share(ratio);
}

CornerBlend blend_at(std::span<const Leg> before, std::span<const Leg> after, double tolerance,
                     CornerKind kind, const Machine& machine) {
    if (moves_other_axes(before) || moves_other_axes(after))
        return blend_of_others(before, after, tolerance, kind == CornerKind::rapids, machine);
    const auto is_arc = [](const Leg& leg) { return leg.arc.motion != nullptr; };
    const bool is_joined = kind == CornerKind::joined_feeds;
    const double middle = 0.5 * length_of(before);
    const double end =
        is_joined && !after.empty() && !is_arc(after.front()) ? infinity : length_of(after);
    CornerBlend blend{{middle, end}, std::min(middle, end)};
    if (before.empty() || after.empty()) return blend;
    const bool is_straight = !is_arc(before.back()) && !is_arc(after.front());
    if (is_straight && tolerance < infinity)
        blend.deviation = std::min(blend.deviation, most_blend_deviation(machine) * tolerance);
    const auto first = side_of(before, true), second = side_of(after, false);
    if (!first || !second) return blend;
    const bool is_rapid = kind == CornerKind::rapids;
    if (is_rapid ? !states_dynamics(machine) : !states_accelerations(machine)) {
        const double half = 0.5 * turn_between(*first, *second);
        if (is_straight && !is_joined && half > least_angle)
            blend.reach.before =
                std::min(middle, cycle * 2.0 * tolerance / core::sin(half - least_angle));
        return blend;
    }
    const double most_override = is_rapid ? 1.0 : feed_override;
    const KnownBlend known(*first, *second, tolerance,
                           {most_override * speed_on(before), most_override * speed_on(after)},
                           machine);
    const bool is_turn_known = !is_joined || (first->is_arc() && second->is_arc());
    const CornerBlend bound =
        is_turn_known ? known.at_known_turn(middle, end) : known.at_any_turn(middle, end);
    blend.reach = bound.reach;
    blend.deviation = std::min(blend.deviation, bound.deviation);
    if (is_turn_known) // circles may reach farther otherwise
        blend.deviation = std::min({blend.deviation, bound.reach.before, bound.reach.after});
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

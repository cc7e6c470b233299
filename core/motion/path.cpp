#include "core/motion/path.h"

#include <algorithm>
#include <numbers>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "core/motion/timing.h"

namespace core {
namespace {

/// The values of a position; empty if the position of an axis is unknown.
std::optional<AxisValues> known(const AxisPosition& p, const Machine& machine) {
    AxisValues values{};
    for (size_t i = 0; i < axis_count; ++i) {
        if (!p[i] && machine.axes[i].present) return std::nullopt;
        values[i] = p[i].value_or(0.0);
    }
    return values;
}

/// The values of a known position.
AxisValues values_of(const AxisPosition& p) {
    AxisValues values{};
    for (size_t i = 0; i < axis_count; ++i) values[i] = p[i].value_or(0.0);
    return values;
}

double rapid_speed(const MachineAxis& axis, Path& path) {
    if (!axis.rapid) path.assumed_speed = true;
    return axis.rapid.value_or(assumed_rapid);
}

/// The time of each axis on its own, seconds.
AxisValues axis_times(const AxisValues& from, const AxisValues& to, const Machine& machine,
                      Path& path) {
    AxisValues times{};
    for (size_t i = 0; i < axis_count; ++i)
        if (to[i] != from[i])
            times[i] =
                std::abs(to[i] - from[i]) / rapid_speed(machine.axes[i], path) * seconds_per_minute;
    return times;
}

double longest_time(const AxisValues& times) {
    return *std::max_element(times.begin(), times.end());
}

AxisValues between(const AxisValues& from, const AxisValues& to, double fraction) {
    AxisValues values = from;
    for (size_t i = 0; i < axis_count; ++i)
        if (to[i] != from[i])
            values[i] = fraction == 1.0 ? to[i] : from[i] + fraction * (to[i] - from[i]);
    return values;
}

void add_straight(Path& path, const AxisValues& from, const AxisValues& to, double duration) {
    path.legs.push_back({{from, to}, path.duration, path.duration + duration, 0.0});
    path.duration += duration;
}

double feed_length(const AxisValues& from, const AxisValues& to) {
    AxisValues by;
    for (size_t i = 0; i < axis_count; ++i) by[i] = to[i] - from[i];
    return fed_length(by);
}

/// The corners of the box of X, Y and Z between two positions; other axes as in the first.
std::vector<AxisValues> box_corners(const AxisValues& low, const AxisValues& high) {
    std::vector<AxisValues> corners;
    for (unsigned i = 0; i < 8; ++i) {
        AxisValues corner = low;
        for (unsigned axis = 0; axis < 3; ++axis)
            if (i >> axis & 1U) corner[axis] = high[axis];
        if (std::find(corners.begin(), corners.end(), corner) == corners.end())
            corners.push_back(corner);
    }
    return corners;
}

/// Number of axes that move.
size_t moving_axes(const AxisValues& from, const AxisValues& to) {
    size_t count = 0;
    for (size_t i = 0; i < axis_count; ++i) count += from[i] != to[i];
    return count;
}

void add_dogleg(Path& path, const Machine& machine, const AxisValues& from, const AxisValues& to,
                bool is_independent) {
    const AxisValues times = axis_times(from, to, machine, path);
    const double total = longest_time(times);
    bool only_linear = true;
    for (size_t i = 3; i < axis_count; ++i) only_linear = only_linear && from[i] == to[i];
    if ((path.assumed_speed || is_independent) && only_linear) {
        path.legs.push_back({.positions = box_corners(from, to),
                             .end = total,
                             .straight = false,
                             .certain = {from, to}});
        path.duration = total;
        return;
    }
    AxisValues bends = times;
    std::sort(bends.begin(), bends.end());
    AxisValues here = from;
    double now = 0.0;
    for (const double bend : bends) {
        if (bend <= now) continue;
        AxisValues next = to;
        for (size_t i = 0; i < axis_count; ++i)
            if (bend < times[i]) next[i] = from[i] + (to[i] - from[i]) * (bend / times[i]);
        add_straight(path, here, next, bend - now);
        here = next;
        now = bend;
    }
}

/// The axis values on an arc at a fraction of its angle.
AxisValues on_arc(const Motion& motion, const AxisValues& from, const AxisValues& to,
                  double fraction) {
    const ArcPath& arc = *motion.arc;
    const auto a = static_cast<size_t>((arc.normal + 1) % 3);
    const auto b = static_cast<size_t>((arc.normal + 2) % 3);
    const double centre[2] = {arc.centre[(arc.normal + 1) % 3], arc.centre[(arc.normal + 2) % 3]};
    const double u = from[a] - centre[0], v = from[b] - centre[1];
    const double end_radius = core::hypot(to[a] - centre[0], to[b] - centre[1]);
    const double radius = core::hypot(u, v);
    // A small difference of the radii is spread evenly over the angle, as controls do.
    const double scale = radius > 0.0 ? 1.0 + fraction * (end_radius / radius - 1.0) : 1.0;
    const double angle = fraction * arc.angle;
    AxisValues p = between(from, to, fraction);
    p[a] = centre[0] + scale * (u * core::cos(angle) - v * core::sin(angle));
    p[b] = centre[1] + scale * (u * core::sin(angle) + v * core::cos(angle));
    return p;
}

/// The radii at both ends.
std::pair<double, double> arc_radii(const ArcPath& arc, const AxisValues& from,
                                    const AxisValues& to) {
    const int a = (arc.normal + 1) % 3, b = (arc.normal + 2) % 3;
    const auto radius = [&](const AxisValues& position) {
        return core::hypot(position[static_cast<size_t>(a)] - arc.centre[a],
                           position[static_cast<size_t>(b)] - arc.centre[b]);
    };
    return {radius(from), radius(to)};
}

/// The curvature factor of an arc or spiral: for a step of the angle, its distance from a chord
/// passed at constant speed is at most this times the square of the step.
///
/// It is an eighth of the second derivative by the angle. The component of that towards the centre
/// is the radius, and the tangential component is twice the change of the radius per angle.
double bend(const ArcPath& arc, const AxisValues& from, const AxisValues& to) {
    const auto [first, last] = arc_radii(arc, from, to);
    const double drift = arc.angle != 0.0 ? 2.0 * (last - first) / arc.angle : 0.0;
    return 0.125 * core::hypot(std::max(first, last), drift);
}

/// The greatest number of chords of an arc; enough for a circle with a radius of some kilometres.
constexpr double most_chords = 100'000.0;

void add_arc(Path& path, const Motion& motion, const AxisValues& from, const AxisValues& to,
             double max_error) {
    const ArcPath& arc = *motion.arc;
    const auto [first_radius, last_radius] = arc_radii(arc, from, to);
    const double radius = std::max(first_radius, last_radius);
    const double widest = radius > max_error ? 2.0 * core::acos(1.0 - 0.5 * max_error / radius)
                                             : std::numbers::pi / 2.0;
    // If the radius changes fast, that chord would be too long.
    const double most = std::sqrt(max_error / std::max(bend(arc, from, to), 1e-12));
    const double step = std::min({widest, most, std::numbers::pi / 2.0});
    const double needed = std::max(1.0, std::ceil(std::abs(arc.angle) / step));
    const int count = static_cast<int>(std::min(needed, most_chords));
    // The distance from a chord grows with the square of its angle; 1 % for the terms beyond.
    const double error =
        needed > count ? 1.01 * max_error * (needed / count) * (needed / count) : max_error;
    const auto normal = static_cast<size_t>(arc.normal);
    const double rise = to[normal] - from[normal];
    const double length = core::hypot(radius * arc.angle, rise);
    path.duration = motion.feed > 0.0 ? length / motion.feed * seconds_per_minute : 0.0;
    const auto whole = std::make_shared<const Motion>(motion);
    AxisValues here = from;
    double before = 0.0;
    for (int i = 1; i <= count; ++i) {
        const double fraction = static_cast<double>(i) / count;
        const AxisValues next = i == count ? to : on_arc(motion, from, to, fraction);
        Leg chord{{here, next}, path.duration * (i - 1) / count, path.duration * fraction, error};
        chord.arc = {whole, before, fraction};
        path.legs.push_back(std::move(chord));
        here = next;
        before = fraction;
    }
}

/// Whether a rotary axis changes the direction of a linear one.
bool turns_linear_axes(const Machine& machine) {
    for (size_t i = 0; i < axis_count; ++i) {
        if (is_rotary(i) || !machine.axes[i].present) continue;
        LinkId link = machine.axes[i].carrier;
        while (link != LinkId::base) {
            const MachineAxis& by = machine.axes[static_cast<size_t>(link)];
            const Vec3 across = glm::cross(by.direction, machine.axes[i].direction);
            if (is_rotary(static_cast<size_t>(link)) && glm::length(across) > 1e-12) return true;
            link = by.carrier;
        }
    }
    return false;
}

/// A path of the tip as legs with constant axis rates, on a machine whose linear axes keep their
/// directions relative to each other.
///
/// Between two moments the linear axes deviate from constant rates by an eighth of their
/// acceleration. The tip is at most r from every rotary axis and moves by v relative to the work
/// while the rotary axes turn by w in all. The linear axes compensate for that, so their
/// acceleration is at most 2 w (w r + v).
void add_tip_path(Path& path, const Machine& machine, const Motion& motion, const AxisValues& from,
                  const AxisValues& to, double max_error) {
    const TipPath& tip = *motion.tip;
    const auto at = [&](double fraction) {
        const AxisValues rotary = between(from, to, fraction);
        return reach_tip(machine, rotary, tip.from + fraction * (tip.to - tip.from),
                         tip.tool_length)
            .value_or(rotary);
    };
    const double travel = glm::distance(tip.from, tip.to);
    const double turn = turn_of(machine, from, to);
    const double farthest = std::max(tip_reach(machine, tip.from, tip.tool_length),
                                     tip_reach(machine, tip.to, tip.tool_length));
    const double bend = 2.0 * turn * (turn * farthest + travel);
    const int count = std::clamp(
        static_cast<int>(std::ceil(std::max(std::sqrt(bend / (8.0 * max_error)), 2.0 * turn))), 1,
        1'000'000);
    path.duration = motion.feed > 0.0 ? (travel > 0.0 ? travel : feed_length(from, to))
                                            / motion.feed * seconds_per_minute
                                      : longest_time(axis_times(from, to, machine, path));
    AxisValues here = from;
    for (int i = 1; i <= count; ++i) {
        const double fraction = static_cast<double>(i) / count;
        const AxisValues next = i == count ? to : at(fraction);
        // The linear axes compensate for the error of the rotary ones.
        const double compensation = 1.01 * tip.turn_error * farthest;
        path.legs.push_back({{here, next},
                             path.duration * (i - 1) / count,
                             path.duration * fraction,
                             (turn > 0.0 ? max_error : 0.0) + compensation,
                             tip.turn_error,
                             compensation});
        here = next;
    }
}

/// All straight paths to the end from any position within the limits.
void add_from_unknown(Path& path, const Machine& machine, const Motion& motion) {
    AxisValues starts[2] = {}, ends[2] = {};
    for (size_t i = 0; i < axis_count; ++i) {
        const MachineAxis& axis = machine.axes[i];
        if (!axis.present) continue;
        const bool is_known = motion.from[i] && motion.to[i];
        if (!is_known && (i >= 3 || !axis.min || !axis.max)) return;
        if (i >= 3 && motion.from[i] != motion.to[i]) return;
        starts[0][i] = motion.from[i].value_or(axis.min.value_or(0.0));
        starts[1][i] = motion.from[i].value_or(axis.max.value_or(0.0));
        ends[0][i] = motion.to[i].value_or(axis.min.value_or(0.0));
        ends[1][i] = motion.to[i].value_or(axis.max.value_or(0.0));
    }
    Leg leg{
        .positions = box_corners(starts[0], starts[1]), .straight = false, .start_known = false};
    if (const auto to = known(motion.to, machine)) {
        leg.certain = {*to};
        leg.positions.push_back(*to);
    } else { // an axis that was never commanded: unknown position throughout
        for (size_t i = 0; i < 3; ++i) {
            starts[0][i] = std::min(starts[0][i], ends[0][i]);
            starts[1][i] = std::max(starts[1][i], ends[1][i]);
        }
        leg.positions = box_corners(starts[0], starts[1]);
    }
    path.legs.push_back(std::move(leg));
}

void extend(AxisRange& range, const AxisValues& position, double by = 0.0) {
    for (size_t i = 0; i < axis_count; ++i) {
        range.min[i] = std::min(range.min[i], position[i] - by);
        range.max[i] = std::max(range.max[i], position[i] + by);
    }
}

} // namespace

double chord_error(double mesh_size) { return std::clamp(mesh_size / 200.0, 1e-4, 0.0025); }

Leg stretch(const Leg& leg, double first, double last) {
    const auto time = [&](double fraction) { return leg.begin + fraction * (leg.end - leg.begin); };
    return {{between(leg.positions[0], leg.positions[1], first),
             between(leg.positions[0], leg.positions[1], last)},
            time(first),
            time(last),
            leg.path_error,
            leg.turn_error,
            leg.lasting_error};
}

std::array<Leg, 2> halves(const Leg& leg) {
    std::array<Leg, 2> parts = {stretch(leg, 0.0, 0.5), stretch(leg, 0.5, 1.0)};
    if (!leg.arc.motion) return parts;
    const Motion& motion = *leg.arc.motion;
    const AxisValues from = values_of(motion.from), to = values_of(motion.to);
    const double middle = 0.5 * (leg.arc.first + leg.arc.last);
    const double step = (leg.arc.last - middle) * motion.arc->angle;
    parts[0].positions[1] = parts[1].positions[0] = on_arc(motion, from, to, middle);
    parts[0].arc = {leg.arc.motion, leg.arc.first, middle};
    parts[1].arc = {leg.arc.motion, middle, leg.arc.last};
    for (Leg& part : parts)
        part.path_error =
            std::min(leg.path_error, bend(*motion.arc, from, to) * step * step + leg.lasting_error);
    return parts;
}

Leg still_half_way(const Leg& leg) {
    const Leg first_half = halves(leg)[0];
    Leg still = first_half;
    still.positions = {first_half.positions[1]};
    still.begin = first_half.end;
    if (leg.arc.motion) still.path_error = leg.lasting_error;
    still.arc = {};
    return still;
}

bool is_dogleg(const Motion& motion, const Machine& machine) {
    return motion.kind == MotionKind::rapid
           && motion.style.value_or(machine.rapid) != RapidStyle::straight;
}

Path path_of(const Motion& motion, const Machine& machine, double max_error) {
    Path path;
    const auto from = known(motion.from, machine), to = known(motion.to, machine);
    if (!from || !to) {
        add_from_unknown(path, machine, motion);
    } else if (motion.arc) {
        add_arc(path, motion, *from, *to, max_error);
    } else if (motion.tip) {
        if (turn_of(machine, *from, *to) == 0.0 || !turns_linear_axes(machine))
            add_tip_path(path, machine, motion, *from, *to, max_error);
    } else if (motion.kind != MotionKind::rapid) {
        add_straight(path, *from, *to,
                     motion.feed > 0.0 ? feed_length(*from, *to) / motion.feed * seconds_per_minute
                                       : 0.0);
    } else if (is_dogleg(motion, machine) && moving_axes(*from, *to) > 1) {
        add_dogleg(path, machine, *from, *to, motion.style == RapidStyle::independent);
    } else {
        add_straight(path, *from, *to, longest_time(axis_times(*from, *to, machine, path)));
    }
    for (Leg& leg : path.legs) {
        leg.path_error += motion.path_error;
        leg.lasting_error += motion.path_error;
        leg.turn_error += motion.turn_error;
    }
    return path;
}

namespace {

/// A position moved to a corner of a spread, by one bit for each axis; empty if another choice
/// gives the same corner.
std::optional<AxisValues> corner_of(AxisValues position, const AxisSpread& spread, unsigned bits) {
    for (size_t i = 0; i < axis_count; ++i) {
        const bool is_above = bits >> i & 1U;
        if (is_above && spread.above[i] == -spread.below[i]) return std::nullopt;
        position[i] += is_above ? spread.above[i] : -spread.below[i];
    }
    return position;
}

void add_corners(std::vector<AxisValues>& corners, const AxisValues& position,
                 const AxisSpread& spread) {
    for (unsigned bits = 0; bits < 1U << axis_count; ++bits)
        if (const auto corner = corner_of(position, spread, bits))
            if (std::find(corners.begin(), corners.end(), *corner) == corners.end())
                corners.push_back(*corner);
}

/// The corners of the box around positions, whose rotary axes are the same.
std::vector<AxisValues> corners_around(const std::vector<AxisValues>& positions) {
    const AxisValues first = positions.front();
    AxisRange range{first, first};
    for (const AxisValues& position : positions) extend(range, position);
    AxisSpread box;
    for (size_t i = 0; i < axis_count; ++i) {
        box.below[i] = first[i] - range.min[i];
        box.above[i] = range.max[i] - first[i];
    }
    std::vector<AxisValues> corners;
    add_corners(corners, first, box);
    return corners;
}

/// The smallest spread that contains two.
AxisSpread joined(const AxisSpread& a, const AxisSpread& b) {
    AxisSpread both;
    for (size_t i = 0; i < axis_count; ++i) {
        both.below[i] = std::max(a.below[i], b.below[i]);
        both.above[i] = std::max(a.above[i], b.above[i]);
    }
    return both;
}

/// Whether a spread leaves the rotary axes alone, and the axes along which an arc bends.
bool is_along_other_axes(const Motion& motion, const AxisSpread& spread) {
    for (size_t i = 0; i < axis_count; ++i) {
        const bool bends = motion.arc && i < 3 && i != static_cast<size_t>(motion.arc->normal);
        if ((is_rotary(i) || bends) && (spread.below[i] != 0.0 || spread.above[i] != 0.0))
            return false;
    }
    return true;
}

} // namespace

Path path_of(const Motion& motion, const AxisSpread& from, const AxisSpread& to,
             const Machine& machine, double max_error) {
    Path path = path_of(motion, machine, max_error);
    if ((from.none() && to.none()) || path.legs.empty() || !path.legs[0].start_known) return path;
    const AxisSpread spread = joined(from, to);
    bool is_known = !motion.tip && is_along_other_axes(motion, spread);
    for (size_t i = 3; i < 6; ++i) is_known = is_known && motion.from[i] == motion.to[i];
    if (!is_known) {
        path.legs.clear();
        return path;
    }
    std::vector<Leg> legs;
    if (motion.arc) {
        for (const Leg& chord : path.legs) {
            Leg hull{.begin = chord.begin,
                     .end = chord.end,
                     .path_error = chord.path_error,
                     .straight = false};
            for (const AxisValues& end : chord.positions) add_corners(hull.positions, end, spread);
            legs.push_back(std::move(hull));
        }
    } else {
        Leg hull{.end = path.duration,
                 .path_error = motion.path_error,
                 .turn_error = motion.turn_error,
                 .straight = false};
        add_corners(hull.positions, values_of(motion.from), from);
        add_corners(hull.positions, values_of(motion.to), to);
        // A dog leg leaves the hull of its ends, but not their box.
        if (is_dogleg(motion, machine)) hull.positions = corners_around(hull.positions);
        legs.push_back(std::move(hull));
    }
    if (from.none()) legs.front().certain.push_back(values_of(motion.from));
    if (to.none()) legs.back().certain.push_back(values_of(motion.to));
    path.legs = std::move(legs);
    return path;
}

AxisSet uncertain_after(const Motion& motion, AxisSet before) {
    if (!motion.stops_at_contact) return static_cast<AxisSet>(before & ~motion.settles);
    AxisSet after = before;
    for (size_t i = 0; i < axis_count; ++i)
        if (motion.from[i] != motion.to[i]) after |= static_cast<AxisSet>(1U << i);
    return after;
}

AxisSpread spread_after(const Motion& motion, AxisSpread spread) {
    for (size_t i = 0; i < axis_count; ++i)
        if ((motion.settles >> i & 1U) || !motion.to[i]) spread.below[i] = spread.above[i] = 0.0;
    return spread;
}

AxisRange axis_range(const Motion& motion, const Machine& machine, double max_error) {
    AxisRange range;
    range.min.fill(infinity);
    range.max.fill(-infinity);
    const AxisValues from = *known(motion.from, machine), to = *known(motion.to, machine);
    extend(range, from);
    extend(range, to);
    if (motion.tip) {
        const Path path = path_of(motion, machine, max_error);
        for (const Leg& leg : path.legs)
            if (&leg != &path.legs.back()) extend(range, leg.positions[1], leg.path_error);
        return range;
    }
    if (!motion.arc) return range;
    const ArcPath& arc = *motion.arc;
    const int a = (arc.normal + 1) % 3, b = (arc.normal + 2) % 3;
    const double start = core::atan2(from[static_cast<size_t>(b)] - arc.centre[b],
                                     from[static_cast<size_t>(a)] - arc.centre[a]);
    // The extremes of the two axes are at multiples of a quarter turn.
    const double quarter = std::numbers::pi / 2.0;
    const double first = std::min(start, start + arc.angle), last = first + std::abs(arc.angle);
    for (double k = std::ceil(first / quarter); k * quarter <= last; ++k) {
        const double fraction = (k * quarter - start) / arc.angle;
        extend(range, on_arc(motion, from, to, std::clamp(fraction, 0.0, 1.0)));
    }
    return range;
}

} // namespace core

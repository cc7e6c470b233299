#include "core/motion/timing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "core/motion/path.h"

namespace core {
namespace {

constexpr double half_root_of_three = 0.8660254037844386;

bool bends(const PathMotion& motion) {
    return std::any_of(motion.bend.begin(), motion.bend.end(), [](double b) { return b > 0.0; });
}

/// The limit along the path from the limit of an axis; an axis at rest imposes none.
double fraction(double limit, double rate) { return rate > 0.0 ? limit / rate : infinity; }

/// Accelerates and decelerates between two speeds, given as squares, within a length.
MotionTime trapezoid(const WaitingMotion& motion, double enter_squared, double leave_squared) {
    MotionTime time{.tag = motion.tag, .length = motion.length};
    time.acceleration = motion.acceleration;
    const double reached = 0.5 * (enter_squared + leave_squared) + time.acceleration * time.length;
    time.enter = std::sqrt(enter_squared);
    time.leave = std::sqrt(leave_squared);
    time.cruise = std::sqrt(std::min(motion.cruise_squared, reached));
    // Rounding must not make the top speed less than the entry speed.
    time.cruise = std::max({time.cruise, time.enter, time.leave});
    const double a = time.acceleration;
    const double up = time.cruise - time.enter, down = time.cruise - time.leave;
    const double ramps =
        0.5 * (up * (time.cruise + time.enter) + down * (time.cruise + time.leave));
    time.duration = (up + down) / a + std::max(0.0, time.length - ramps / a) / time.cruise;
    return time;
}

/// Makes the first waiting motion final.
void settle_first(TimePlan& plan, std::vector<MotionTime>& done) {
    const WaitingMotion first = plan.waiting.front();
    plan.waiting.pop_front();
    const double enter_squared = plan.enter * plan.enter;
    const double reachable = enter_squared + 2.0 * first.acceleration * first.length;
    const double leave_squared =
        plan.waiting.empty() ? 0.0 : std::min(plan.waiting.front().entry_squared, reachable);
    done.push_back(trapezoid(first, enter_squared, leave_squared));
    plan.enter = done.back().leave;
}

/// Updates the entry speeds for the new end. Speeds only rise as more motions become known, so the
/// loop ends at the first that does not change.
void limit_backwards(TimePlan& plan) {
    double after = 0.0;
    for (size_t i = plan.waiting.size(); i-- > 0;) {
        WaitingMotion& motion = plan.waiting[i];
        const double entry =
            std::min(motion.corner_squared, after + 2.0 * motion.acceleration * motion.length);
        if (entry == motion.entry_squared) return;
        motion.entry_squared = after = entry;
    }
}

double bend_speed(const MachineLimits& limits, const PathMotion& motion, double part) {
    double squared = infinity;
    for (size_t i = 0; i < limits.size(); ++i)
        squared = std::min(squared, fraction(part * limits[i].acceleration, motion.bend[i]));
    return std::sqrt(squared);
}

} // namespace

double MotionTime::moment(double travelled) const {
    const double a = acceleration;
    const double rise = 0.5 * (cruise - enter) * (cruise + enter) / a;
    const double fall = 0.5 * (cruise - leave) * (cruise + leave) / a;
    const double left = length - travelled;
    // s = v t + a t^2 / 2, solved without the difference of nearly equal numbers.
    const auto ramp = [a](double s, double v) {
        return s > 0.0 ? 2.0 * s / (v + std::sqrt(v * v + 2.0 * a * s)) : 0.0;
    };
    if (travelled < rise) return ramp(travelled, enter);
    if (left < fall) return duration - ramp(left, leave);
    return std::min(duration, (cruise - enter) / a + (travelled - rise) / cruise);
}

double cruise_speed(const MachineLimits& limits, const PathMotion& motion) {
    double speed = std::min(motion.speed, bend_speed(limits, motion, half_root_of_three));
    for (size_t i = 0; i < limits.size(); ++i)
        speed = std::min(speed, fraction(limits[i].speed, motion.fastest[i]));
    return speed;
}

double path_acceleration(const MachineLimits& limits, const PathMotion& motion) {
    double acceleration = infinity;
    for (size_t i = 0; i < limits.size(); ++i) {
        const double part = motion.bend[i] > 0.0 ? 0.5 : 1.0;
        acceleration =
            std::min(acceleration, fraction(part * limits[i].acceleration, motion.fastest[i]));
    }
    return acceleration;
}

double corner_speed(const TimePlan& plan, const PathMotion& before, const PathMotion& after) {
    if (plan.blending == Blending::exact_stop) return 0.0;
    // The time by which an axis must slow down or speed up, per unit of speed along the path.
    double sharpness = 0.0, turn_squared = 0.0;
    for (size_t i = 0; i < plan.limits.size(); ++i) {
        const double change = std::abs(after.start[i] - before.end[i]);
        sharpness = std::max(sharpness, change / plan.limits[i].acceleration);
        if (i < 3 || i >= 6) turn_squared += change * change;
    }
    if (sharpness == 0.0) return infinity;
    const double jump = control_cycle / sharpness;
    if (plan.blending == Blending::exact_path) return jump;
    const bool curved = bends(before) || bends(after);
    if (curved) sharpness *= 2.0;
    // At speed v the parabola lasts v * sharpness, begins half of v^2 * sharpness before the
    // corner, and misses it by an eighth of turn * v^2 * sharpness.
    const double room = std::min(before.length, after.length) / sharpness;
    const double within = 8.0 * plan.tolerance / (std::sqrt(turn_squared) * sharpness);
    double rounded = std::sqrt(std::min(room, within));
    if (curved)
        rounded = std::min(
            {rounded, bend_speed(plan.limits, before, 0.5), bend_speed(plan.limits, after, 0.5)});
    return std::max(jump, rounded);
}

void add_motion(TimePlan& plan, const PathMotion& motion, uint32_t tag,
                std::vector<MotionTime>& done) {
    WaitingMotion next{.tag = tag, .length = motion.length};
    next.acceleration = path_acceleration(plan.limits, motion);
    const double cruise = cruise_speed(plan.limits, motion);
    next.cruise_squared = cruise * cruise;
    next.entry_squared = -1.0;
    next.corner_squared = 0.0;
    if (plan.last) {
        const double before = cruise_speed(plan.limits, *plan.last);
        const double corner = std::min({corner_speed(plan, *plan.last, motion), before, cruise});
        next.corner_squared = corner * corner;
    }
    plan.waiting.push_back(next);
    plan.last = motion;
    limit_backwards(plan);
    if (plan.waiting.size() > look_ahead) settle_first(plan, done);
}

void plan_stop(TimePlan& plan, std::vector<MotionTime>& done) {
    while (!plan.waiting.empty()) settle_first(plan, done);
    plan.last.reset();
    plan.enter = 0.0;
}

namespace {

/// The travel of each axis; empty if unknown. An axis with an unknown position that is not
/// commanded to move stays in place.
std::optional<AxisValues> travels(const Motion& motion) {
    AxisValues by{};
    for (size_t i = 0; i < motion.from.size(); ++i) {
        if (motion.from[i].has_value() != motion.to[i].has_value()) return std::nullopt;
        if (motion.from[i]) by[i] = *motion.to[i] - *motion.from[i];
    }
    return by;
}

/// The length to which a feed refers: with tool centre point control, the length of the tip's path,
/// unless the tool only rotates about the tip.
double feed_length(const Motion& motion, const AxisValues& by) {
    if (motion.tip && motion.kind != MotionKind::rapid)
        if (const double way = glm::distance(motion.tip->from, motion.tip->to); way > 0.0)
            return way;
    return fed_length(by);
}

double axis_speed(const Machine& machine, size_t axis) {
    return machine.axes[axis].rapid.value_or(assumed_rapid) / seconds_per_minute;
}

PathMotion along_line(const AxisValues& by, double length) {
    PathMotion path{.length = length};
    for (size_t i = 0; i < by.size(); ++i) {
        path.start[i] = path.end[i] = by[i] / length;
        path.fastest[i] = std::abs(path.start[i]);
    }
    return path;
}

/// The greatest |cos| of any angle between two angles.
double greatest_cosine(double first, double last) {
    const double pi = std::numbers::pi;
    if (std::floor(last / pi) >= std::ceil(first / pi)) return 1.0;
    return std::max(std::abs(sin_cos(first).cos), std::abs(sin_cos(last).cos));
}

/// A circle, helix or spiral: at the path length s of L, it has turned by the fraction s/L of the
/// angle.
std::optional<PathMotion> along_arc(const Motion& motion, const AxisValues& by) {
    const ArcPath& arc = *motion.arc;
    const auto a = static_cast<size_t>((arc.normal + 1) % 3);
    const auto b = static_cast<size_t>((arc.normal + 2) % 3);
    if (!motion.from[a] || !motion.from[b]) return std::nullopt;
    const double u = *motion.from[a] - arc.centre[static_cast<int>(a)];
    const double v = *motion.from[b] - arc.centre[static_cast<int>(b)];
    const double radius = core::hypot(u, v);
    const double drift = core::hypot(u + by[a], v + by[b]) - radius;
    const double widest = std::max(radius, radius + drift);
    const double turn = std::abs(arc.angle);
    const double length = core::hypot(widest * turn, by[static_cast<size_t>(arc.normal)]);
    if (!(length > 0.0) || !(radius > 0.0)) return std::nullopt;
    PathMotion path = along_line(by, length);
    const double first = angle_of(v, u), second = first + arc.angle;
    const auto rates = [&](double angle, double reach, AxisValues& rate) {
        const SinCos at = sin_cos(angle);
        rate[a] = (drift * at.cos - reach * arc.angle * at.sin) / length;
        rate[b] = (drift * at.sin + reach * arc.angle * at.cos) / length;
    };
    rates(first, radius, path.start);
    rates(second, radius + drift, path.end);
    const double low = std::min(first, second), high = std::max(first, second);
    const double quarter = std::numbers::pi / 2.0;
    const double cosine = greatest_cosine(low, high);
    const double sine = greatest_cosine(low - quarter, high - quarter);
    const double side = 2.0 * std::abs(drift) * turn;
    path.fastest[a] = (widest * turn * sine + std::abs(drift)) / length;
    path.fastest[b] = (widest * turn * cosine + std::abs(drift)) / length;
    path.bend[a] = (widest * turn * turn * cosine + side) / (length * length);
    path.bend[b] = (widest * turn * turn * sine + side) / (length * length);
    return path;
}

/// The axis motion while the control keeps the tip on a line, sampled at even steps.
///
/// The linear axes compensate for w radians of turning at a distance of at most r and for the tip's
/// travel v. With the motion's fraction as parameter, their rate is at most w r + v, its derivative
/// at most 2 w (w r + v), and the derivative of that at most 3 w^2 (w r + v). This bounds the
/// values between the steps, too.
PathMotion along_tip(const Motion& motion, const Machine& machine, const AxisValues& by,
                     double length) {
    constexpr int most_steps = 64;
    AxisValues from{};
    for (size_t i = 0; i < by.size(); ++i) from[i] = motion.from[i].value_or(0.0);
    AxisValues to = from;
    for (size_t i = 0; i < by.size(); ++i) to[i] += by[i];
    const double turn = turn_of(machine, from, to);
    // So that no axis seems faster than it is by more than 0.5 %.
    const int steps = std::clamp(static_cast<int>(std::ceil(200.0 * turn)), 8, most_steps);
    const TipPath& tip = *motion.tip;
    std::array<AxisValues, most_steps + 1> at;
    for (int k = 0; k <= steps; ++k) {
        const double fraction = static_cast<double>(k) / steps;
        for (size_t i = 0; i < by.size(); ++i)
            at[static_cast<size_t>(k)][i] = from[i] + fraction * by[i];
        const auto reached = reach_tip(machine, at[static_cast<size_t>(k)],
                                       tip.from + fraction * (tip.to - tip.from), tip.tool_length);
        if (!reached) return along_line(by, length);
        at[static_cast<size_t>(k)] = *reached;
    }
    const double reach = std::max(tip_reach(machine, tip.from, tip.tool_length),
                                  tip_reach(machine, tip.to, tip.tool_length));
    const double unseen =
        3.0 * turn * turn * (turn * reach + glm::distance(tip.from, tip.to)) / steps;
    PathMotion path = along_line(by, length);
    for (size_t i = 0; i < 3; ++i) {
        const auto rate = [&](int k) {
            const auto n = static_cast<size_t>(k);
            return (at[n + 1][i] - at[n][i]) * steps / length;
        };
        double bend = 0.0, fastest = 0.0;
        for (int k = 0; k < steps; ++k) fastest = std::max(fastest, std::abs(rate(k)));
        for (int k = 0; k + 1 < steps; ++k)
            bend = std::max(bend, std::abs(rate(k + 1) - rate(k)) * steps / length);
        if (turn > 0.0) bend += unseen / (length * length);
        path.start[i] = rate(0) - 0.5 * (rate(1) - rate(0));
        path.end[i] = rate(steps - 1) + 0.5 * (rate(steps - 1) - rate(steps - 2));
        path.fastest[i] = fastest + 0.5 * bend * length / steps;
        // Unlike on a circle, speed change and curvature may need the same axis at once: each gets
        // half of the acceleration.
        path.bend[i] = turn > 0.0 ? std::numbers::sqrt3 * bend : 0.0;
    }
    return path;
}

double rapid_speed(const Machine& machine, const PathMotion& path) {
    double speed = infinity;
    for (size_t i = 0; i < machine.axes.size(); ++i)
        if (path.fastest[i] > 0.0)
            speed = std::min(speed, axis_speed(machine, i) / path.fastest[i]);
    return speed;
}

} // namespace

MachineLimits limits_of(const Machine& machine) {
    MachineLimits limits;
    for (size_t i = 0; i < machine.axes.size(); ++i) {
        const MachineAxis& axis = machine.axes[i];
        if (axis.rapid) limits[i].speed = axis_speed(machine, i);
        limits[i].acceleration = axis.acceleration.value_or(infinity);
    }
    return limits;
}

std::optional<PathMotion> path_motion(const Motion& motion, const Machine& machine) {
    const bool rapid = motion.kind == MotionKind::rapid;
    if (is_dogleg(motion, machine) || (!rapid && !(motion.feed > 0.0))) return std::nullopt;
    const auto by = travels(motion);
    if (!by) return std::nullopt;
    std::optional<PathMotion> path;
    if (motion.arc)
        path = along_arc(motion, *by);
    else if (const double length = feed_length(motion, *by); length > 0.0)
        path = motion.tip ? along_tip(motion, machine, *by, length) : along_line(*by, length);
    if (path) path->speed = rapid ? rapid_speed(machine, *path) : motion.feed / seconds_per_minute;
    return path;
}

DoglegTime dogleg_time(const Motion& motion, const Machine& machine) {
    DoglegTime time;
    const auto by = travels(motion);
    if (!by) return time;
    for (size_t i = 0; i < machine.axes.size(); ++i) {
        const double length = std::abs((*by)[i]);
        if (length == 0.0) continue;
        const double acceleration = machine.axes[i].acceleration.value_or(infinity);
        const double full = axis_speed(machine, i);
        const double reached = std::min(full, std::sqrt(acceleration * length));
        time.duration = std::max(time.duration, length / reached + reached / acceleration);
        time.at_full_speed = std::max(time.at_full_speed, length / full);
    }
    return time;
}

} // namespace core

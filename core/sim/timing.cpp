#include "core/sim/timing.h"

#include <algorithm>
#include <cmath>

namespace core {
namespace {

constexpr double half_root_of_three = 0.8660254037844386;

bool bends(const PathMotion& motion) {
    return std::any_of(motion.bend.begin(), motion.bend.end(), [](double b) { return b > 0.0; });
}

/// What an axis may use up along with a rate; nothing that stands still limits anything.
double share(double limit, double rate) { return rate > 0.0 ? limit / rate : infinity; }

/// Up from one speed and down to another, as squares, within a length.
MotionTime trapezoid(const WaitingMotion& motion, double enter_squared, double leave_squared) {
    MotionTime time{.tag = motion.tag, .length = motion.length};
    time.acceleration = motion.acceleration;
    const double reached = 0.5 * (enter_squared + leave_squared) + time.acceleration * time.length;
    time.enter = std::sqrt(enter_squared);
    time.leave = std::sqrt(leave_squared);
    time.cruise = std::sqrt(std::min(motion.cruise_squared, reached));
    // Rounding must not let the top speed fall below what it rises from.
    time.cruise = std::max({time.cruise, time.enter, time.leave});
    const double a = time.acceleration;
    const double up = time.cruise - time.enter, down = time.cruise - time.leave;
    const double ramps =
        0.5 * (up * (time.cruise + time.enter) + down * (time.cruise + time.leave));
    time.duration = (up + down) / a + std::max(0.0, time.length - ramps / a) / time.cruise;
    return time;
}

/// Makes the first motion that waits final.
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

/// From which speeds the new end can be kept. Speeds only rise as more becomes known, so the first
/// that does not change ends it.
void look_back(TimePlan& plan) {
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
        squared = std::min(squared, share(part * limits[i].acceleration, motion.bend[i]));
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
        speed = std::min(speed, share(limits[i].speed, motion.fastest[i]));
    return speed;
}

double path_acceleration(const MachineLimits& limits, const PathMotion& motion) {
    double acceleration = infinity;
    for (size_t i = 0; i < limits.size(); ++i) {
        const double part = motion.bend[i] > 0.0 ? 0.5 : 1.0;
        acceleration =
            std::min(acceleration, share(part * limits[i].acceleration, motion.fastest[i]));
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
    look_back(plan);
    if (plan.waiting.size() > look_ahead) settle_first(plan, done);
}

void come_to_rest(TimePlan& plan, std::vector<MotionTime>& done) {
    while (!plan.waiting.empty()) settle_first(plan, done);
    plan.last.reset();
    plan.enter = 0.0;
}

} // namespace core

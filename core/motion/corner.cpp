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

/// The greatest speed on straight legs, mm/s.
double speed_on(std::span<const Leg> legs) {
    double speed = 0.0;
    for (const Leg& leg : legs)
        if (leg.end > leg.begin) speed = std::max(speed, length_of(leg) / (leg.end - leg.begin));
    return speed;
}

} // namespace

CornerReach reach_at_speed(std::span<const Leg> before, std::span<const Leg> after,
                           const Machine& machine) {
    CornerReach reach{0.5 * length_of(before), 0.5 * length_of(after)};
    const std::optional<double> turn =
        before.empty() || after.empty() ? std::nullopt : turn_between(before.back(), after.front());
    if (!states_dynamics(machine) || !turn) return reach;
    double least = infinity;
    for (size_t i = 0; i < axis_count; ++i)
        if (machine.axes[i].present && !is_rotary(i))
            least = std::min(least, *machine.axes[i].acceleration);
    // A blend, or a circle.
    const double half = 0.5 * *turn;
    const double of_turn =
        1.01 * std::max(1.0, 2.0 / std::numbers::sqrt3 * core::sin(half)) / core::cos(half);
    const auto at_speed = [&](double speed) { return speed * speed / least * of_turn; };
    return {std::min(reach.before, at_speed(speed_on(before))),
            std::min(reach.after, at_speed(speed_on(after)))};
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

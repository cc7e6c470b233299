#include "core/motion/plane_turn.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"

namespace core {
namespace {

constexpr int many_pieces = 1024, most_pieces = 4096;
constexpr double largest_error = 1e-3; // radians, of many pieces

/// The direction of the tool and of the rotary axes at one position. Frame: the table link.
struct Pose {
    Vec3 tool;
    std::vector<Vec3> axes;

    /// The area that the changes of direction by two axes span.
    double sine() const {
        return axes.size() == 2 ? std::abs(glm::dot(tool, glm::cross(axes[0], axes[1]))) : 0.0;
    }
};

Pose pose_at(const Machine& machine, const std::vector<size_t>& rotary, const AxisValues& values) {
    const Mat3 back = glm::transpose(machine_from_link(machine, machine.table, values).rotation);
    Pose pose{tool_frame(machine, values)[2], {}};
    for (const size_t i : rotary) {
        const MachineAxis& axis = machine.axes[i];
        pose.axes.push_back(back * machine_from_link(machine, axis.carrier, values).rotation
                            * axis.direction);
    }
    return pose;
}

/// A turn to be made: the rotary axes of the machine, its ends, and the poses there.
struct Turn {
    const Machine& machine;
    std::vector<size_t> rotary;
    AxisValues from, to;
    Pose first{}, last{};
};

/// Whether the tool keeps its direction: all axes that move turn about it.
bool keeps_direction(const Turn& whole) {
    constexpr double rounding = 1e-12;
    const Pose& pose = whole.first;
    for (size_t n = 0; n < whole.rotary.size(); ++n) {
        const bool moves = whole.from[whole.rotary[n]] != whole.to[whole.rotary[n]];
        if (moves && glm::length(glm::cross(pose.axes[n], pose.tool)) > rounding) return false;
    }
    return true;
}

/// The turn if one axis alone makes it, at right angles to the tool, before or after another has
/// turned about the tool; empty if not.
std::optional<PlaneTurn> turn_by_one_axis(const Turn& whole) {
    constexpr double rounding = 1e-9;
    const auto& [machine, rotary, from, to, first, last] = whole;
    const auto spins_at = [](const Pose& pose, size_t n) {
        return glm::length(glm::cross(pose.axes[n], pose.tool)) < rounding;
    };
    for (const size_t n : {size_t{0}, size_t{1}}) {
        const size_t tilts = rotary[n], spins = rotary[1 - n];
        if (from[tilts] == to[tilts]) continue;
        PlaneTurn turn;
        AxisValues between = from;
        if (from[spins] != to[spins]) {
            turn.begins_in_place = spins_at(first, 1 - n);
            turn.ends_in_place = !turn.begins_in_place && spins_at(last, 1 - n);
            if (!turn.begins_in_place && !turn.ends_in_place) continue;
            const size_t earlier = turn.begins_in_place ? spins : tilts;
            between[earlier] = to[earlier];
            turn.positions.push_back(between);
        }
        const Pose tilting = turn.begins_in_place ? pose_at(machine, rotary, between) : first;
        const bool in_plane = std::abs(glm::dot(tilting.axes[n], tilting.tool)) < rounding
                              && std::abs(to[tilts] - from[tilts]) < 180.0;
        if (!in_plane) continue;
        turn.positions.push_back(to);
        return turn;
    }
    return std::nullopt;
}

/// A turn in `count` even parts; empty if the axes cannot go that way.
std::optional<PlaneTurn> turn_in_parts(const Turn& whole, int count) {
    const auto& [machine, rotary, from, to, first, last] = whole;
    const double angle =
        angle_of(glm::length(glm::cross(first.tool, last.tool)), glm::dot(first.tool, last.tool));
    const double part = angle / count;
    PlaneTurn turn;
    AxisValues here = from;
    double sine = first.sine();
    for (int i = 1; i <= count; ++i) {
        AxisValues next = to;
        if (i < count) {
            const double along = part * i;
            const Vec3 direction =
                (core::sin(angle - along) * first.tool + core::sin(along) * last.tool)
                / core::sin(angle);
            const auto found = point_tool(machine, here, direction);
            if (!found) return std::nullopt;
            next = *found;
        }
        const double turned = turn_of(machine, here, next);
        const double there = i < count ? pose_at(machine, rotary, next).sine() : last.sine();
        const double least = std::min(sine, there) - 1.01 * turned;
        if (!(least > 0.0)) return std::nullopt;
        const double apart = 0.125 * (turned * turned + part * part);
        if (apart > least * least / 32.0) return std::nullopt;
        turn.error = std::max(turn.error, 4.0 * apart / least);
        turn.sine = std::min(turn.sine, least);
        turn.positions.push_back(next);
        here = next;
        sine = there;
    }
    return turn;
}

} // namespace

std::optional<PlaneTurn> turn_in_plane(const Machine& machine, const AxisValues& from,
                                       const AxisValues& to, double max_error) {
    Turn whole{.machine = machine, .rotary = {}, .from = from, .to = from};
    for (size_t i = 3; i < 6; ++i)
        if (machine.axes[i].present) {
            whole.rotary.push_back(i);
            whole.to[i] = to[i];
        }
    if (whole.rotary.size() < 2 || whole.to == from) return PlaneTurn{{whole.to}};
    if (whole.rotary.size() > 2) return std::nullopt;
    whole.first = pose_at(machine, whole.rotary, from);
    if (keeps_direction(whole)) return PlaneTurn{{whole.to}};
    whole.last = pose_at(machine, whole.rotary, whole.to);
    if (auto turn = turn_by_one_axis(whole)) return turn;
    const double close = whole.first.sine() + whole.last.sine();
    int count = 1;
    if (close > 0.0) { // an estimate
        const double turned = turn_of(machine, from, whole.to);
        count = std::clamp(static_cast<int>(turned / std::sqrt(0.5 * max_error * close)) + 1, 1,
                           most_pieces);
    }
    for (;; count = std::min(2 * count, most_pieces)) {
        auto turn = turn_in_parts(whole, count);
        const double allowed = count < many_pieces ? max_error : std::max(max_error, largest_error);
        if (turn && turn->error <= allowed) return turn;
        if (count == most_pieces) return std::nullopt;
    }
}

} // namespace core

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "core/sim/rules/rules.h"

namespace core {
namespace {

constexpr double far_turn = 20.0;       // degrees: less is no jump
constexpr double turn_per_lean = 5.0;   // an axis that turns so many times as far as the tool leans
constexpr double way_per_degree = 0.05; // mm that the tip moves at most for each degree
constexpr double swing = 0.5;           // mm off the line

/// What the tool and its tip do over a motion, seen from the work.
struct Seen {
    size_t axis = 3;   // the rotary axis that turns farthest
    double turn = 0.0; // of it, degrees
    int turning = 0;   // rotary axes that turn
    double lean = 0.0; // of the tool, degrees
    double way = 0.0;  // of the tip, mm
    double off = 0.0;  // of the tip from the straight line half way, mm
};

/// The direction of the tool seen from the table.
Vec3 direction(const Machine& machine, const AxisValues& values) {
    const Vec3 tip = tip_place(machine, values, 1.0), gauge = tip_place(machine, values, 0.0);
    return gauge - tip;
}

/// Ends and middle; empty where an end is not known.
std::optional<std::array<AxisValues, 3>> places_of(const Motion& motion) {
    std::array<AxisValues, 3> places{};
    for (size_t i = 0; i < axis_count; ++i) {
        if (!motion.from[i] && !motion.to[i] && i >= 3) continue;
        if (!motion.from[i] || !motion.to[i]) return std::nullopt;
        places[0][i] = *motion.from[i];
        places[2][i] = *motion.to[i];
        places[1][i] = 0.5 * (places[0][i] + places[2][i]);
    }
    return places;
}

Seen look(const Machine& machine, const Motion& motion, const std::array<AxisValues, 3>& places,
          double length) {
    Seen seen;
    for (size_t i = 3; i < 6; ++i) {
        const double turn = std::abs(places[2][i] - places[0][i]);
        seen.turning += turn > 1.0;
        if (turn <= seen.turn) continue;
        seen.turn = turn;
        seen.axis = i;
    }
    const double cosine = glm::dot(direction(machine, places[0]), direction(machine, places[2]));
    seen.lean = std::acos(std::clamp(cosine, -1.0, 1.0)) * degrees_per_radian;
    const Vec3 from = tip_place(machine, places[0], length);
    const Vec3 to = tip_place(machine, places[2], length);
    seen.way =
        motion.tip ? glm::distance(motion.tip->from, motion.tip->to) : glm::distance(from, to);
    if (motion.tip) return seen;
    seen.off = glm::distance(tip_place(machine, places[1], length), 0.5 * (from + to));
    seen.way = std::max(seen.way, 2.0 * seen.off);
    return seen;
}

} // namespace

std::optional<Finding> singular_orientation(const Machine& machine, const Motion& motion,
                                            double tool_length) {
    if (motion.kind == MotionKind::rapid || motion.arc || !machine.has_rotary())
        return std::nullopt;
    const auto places = places_of(motion);
    if (!places) return std::nullopt;
    const Seen seen = look(machine, motion, *places, tool_length);
    Finding finding;
    finding.rule = "singular-orientation";
    if (seen.turn >= far_turn && seen.turn > turn_per_lean * seen.lean
        && seen.way < way_per_degree * seen.turn) {
        finding.message =
            fmt::format("Near the pole: {} turns {:.1f} degrees while the tip moves {:.3f} mm and "
                        "the tool leans by {:.2f} degrees. The tool dwells in the cut meanwhile.",
                        axis_letters[seen.axis], seen.turn, seen.way, seen.lean);
        finding.cure = "Lean the tool or the set-up by a few degrees more, away from the pole, or "
                       "retract before the axis swings round.";
        return finding;
    }
    if (motion.tip || seen.turning < 2 || seen.off <= swing) return std::nullopt;
    finding.message = fmt::format(
        "Without tool centre control the tip swings {:.2f} mm off its straight line in this block, "
        "on which {} turns {:.1f} degrees.",
        seen.off, axis_letters[seen.axis], seen.turn);
    finding.cure = "Switch tool centre control on (G43.4), or post the program in shorter blocks.";
    return finding;
}

} // namespace core

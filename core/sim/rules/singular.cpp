#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/rule_table.h"
#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/motion/machine.h"
#include "core/sim/rules/rules.h"

namespace core {
namespace {

constexpr double far_turn = 20.0;       // degrees; a smaller turn is not reported
constexpr double turn_per_lean = 5.0;   // ratio of an axis's turn to the tilt of the tool
constexpr double way_per_degree = 0.05; // mm per degree, greatest travel of the tip
constexpr double swing = 0.5;           // mm, deviation from the line

/// Motion of the tool and its tip, seen from the work.
struct Seen {
    size_t axis = 3;   // rotary axis with the largest turn
    double turn = 0.0; // of that axis, degrees
    int turning = 0;   // number of rotary axes that turn
    double lean = 0.0; // tilt of the tool, degrees
    double way = 0.0;  // travel of the tip, mm
    double off = 0.0;  // deviation of the tip from the straight line half way, mm
};

/// Direction of the tool in the table's frame.
Vec3 direction(const Machine& machine, const AxisValues& values) {
    const Vec3 tip = tip_position(machine, values, 1.0), gauge = tip_position(machine, values, 0.0);
    return gauge - tip;
}

/// Positions at start, middle and end; empty if an end is unknown.
std::optional<std::array<AxisValues, 3>> positions_of(const Motion& motion) {
    std::array<AxisValues, 3> positions{};
    for (size_t i = 0; i < axis_count; ++i) {
        if (!motion.from[i] && !motion.to[i] && i >= 3) continue;
        if (!motion.from[i] || !motion.to[i]) return std::nullopt;
        positions[0][i] = *motion.from[i];
        positions[2][i] = *motion.to[i];
        positions[1][i] = 0.5 * (positions[0][i] + positions[2][i]);
    }
    return positions;
}

Seen measure(const Machine& machine, const Motion& motion,
             const std::array<AxisValues, 3>& positions, double length) {
    Seen seen;
    for (size_t i = 3; i < 6; ++i) {
        const double turn = std::abs(positions[2][i] - positions[0][i]);
        seen.turning += turn > 1.0;
        if (turn <= seen.turn) continue;
        seen.turn = turn;
        seen.axis = i;
    }
    const double cosine =
        glm::dot(direction(machine, positions[0]), direction(machine, positions[2]));
    seen.lean = core::acos(std::clamp(cosine, -1.0, 1.0)) * degrees_per_radian;
    const Vec3 from = tip_position(machine, positions[0], length);
    const Vec3 to = tip_position(machine, positions[2], length);
    seen.way =
        motion.tip ? glm::distance(motion.tip->from, motion.tip->to) : glm::distance(from, to);
    if (motion.tip) return seen;
    seen.off = glm::distance(tip_position(machine, positions[1], length), 0.5 * (from + to));
    seen.way = std::max(seen.way, 2.0 * seen.off);
    return seen;
}

} // namespace

std::optional<Finding> singular_orientation(const Machine& machine, const Motion& motion,
                                            double tool_length) {
    if (motion.kind == MotionKind::rapid || motion.arc || !machine.has_rotary())
        return std::nullopt;
    const auto positions = positions_of(motion);
    if (!positions) return std::nullopt;
    const Seen seen = measure(machine, motion, *positions, tool_length);
    Finding finding;
    finding.rule = rule_id("singular-orientation");
    if (seen.turn >= far_turn && seen.turn > turn_per_lean * seen.lean
        && seen.way < way_per_degree * seen.turn) {
        finding.message =
            fmt::format("Near a singular orientation: {} turns {:.1f} degrees while the tip moves "
                        "{:.3f} mm and "
                        "the tool tilts by {:.2f} degrees. Meanwhile the tool dwells in the cut.",
                        axis_letters[seen.axis], seen.turn, seen.way, seen.lean);
        finding.cure = "Tilt the tool or the work a few degrees farther away from it, or "
                       "retract before the axis swings round.";
        return finding;
    }
    if (motion.tip || seen.turning < 2 || seen.off <= swing) return std::nullopt;
    finding.message = fmt::format(
        "Without tool centre point control, the tip swings {:.2f} mm off its straight line in this "
        "block, in which {} turns {:.1f} degrees.",
        seen.off, axis_letters[seen.axis], seen.turn);
    finding.cure =
        "Switch on tool centre point control (G43.4), or post the program in shorter blocks.";
    return finding;
}

} // namespace core

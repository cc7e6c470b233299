#pragma once

#include <optional>
#include <vector>

#include "core/motion/event.h"

namespace core {

struct Leg;
struct Machine;

/// Where a link of the machine stands; the identity when the axes that carry it are at 0.
Transform machine_from_link(const Machine& machine, LinkId link, const AxisValues& values);

/// Whether any rotary axis stands between the link and the base.
bool is_turned_by_axes(const Machine& machine, LinkId link);

/// Whether the link moves with the table's side of the machine.
bool is_on_table_side(const Machine& machine, LinkId link);

/// The pose of one mounted body seen from another.
Transform target_from_mover(const Machine& machine, const Mount& target, const Mount& mover,
                            const AxisValues& values);

/// The axis values that bring the tip of a tool to a place, the rotary axes being where they are.
///
/// Frame:  `tip` is that of the table's link.
/// Result: X, Y and Z changed, all others as given; empty when the machine's X, Y and Z do not span
///         space.
std::optional<AxisValues> reach_tip(const Machine& machine, const AxisValues& values,
                                    const Vec3& tip, double tool_length);

/// Where the tip of a tool stands. Frame: the table's link.
Vec3 tip_place(const Machine& machine, const AxisValues& values, double tool_length);

/// How much the rotary axes turn between two positions, all together, radians.
double turn_of(const Machine& machine, const AxisValues& from, const AxisValues& to);

/// A length that the distance of a tool's tip from any rotary axis never exceeds, however the
/// rotary axes stand, while the tip is at this place. Frame: the table's link.
double tip_reach(const Machine& machine, const Vec3& tip, double tool_length);

/// How one mounted body moves past another over a leg of a path: it does not turn, and its origin
/// goes straight from place to place (or through their hull), but every point of it may be `error`
/// away from there. Frame: that of the target.
struct RelativeLeg {
    Mat3 orientation = Mat3(1.0);
    std::vector<Vec3> places; // of the mover's origin
    double error = 0.0;       // of the path and of turning, mm; infinite beyond half a radian
    double travel = 0.0;      // no point goes farther, mm
    bool turns = false;       // the orientation is the one half way
};

/// A body that is mounted: no point of it is farther from `centre` (its own frame) than `reach`.
struct Mover {
    Mount mount;
    Vec3 centre = Vec3(0.0);
    double reach = 0.0;
    double form_error = 0.0; // of its shape; adds to the errors of its legs
};

/// The leg as the target sees the mover pass.
///
/// Proof of the error: README.md, "Turning".
RelativeLeg relative_leg(const Machine& machine, const Mount& target, const Mover& mover,
                         const Leg& leg);

/// The values of the rotary axes that let the tool point along a direction.
///
/// Frame:  `tool_axis`, from the tip up, is that of the table's link.
/// Result: of all ways within the limits the one with the least turning from `values`; empty when
///         no rotary axes reach the direction.
std::optional<AxisValues> point_tool(const Machine& machine, const AxisValues& values,
                                     const Vec3& tool_axis);

} // namespace core

#pragma once

#include <optional>
#include <vector>

#include "core/geom/gjk.h"
#include "core/motion/event.h"

namespace core {

struct Leg;
struct Machine;

/// The pose of a link; the identity when the axes that carry it are at 0.
Transform machine_from_link(const Machine& machine, LinkId link, const AxisValues& values);

/// Whether a rotary axis lies between the link and the base.
bool is_turned_by_axes(const Machine& machine, LinkId link);

/// Whether the link is on the table side.
bool is_on_table_side(const Machine& machine, LinkId link);

/// The pose of one mounted body relative to another.
Transform target_from_mover(const Machine& machine, const Mount& target, const Mount& mover,
                            const AxisValues& values);

/// The axis values that bring the tool tip to a point while the rotary axes stay.
///
/// Frame:   `tip` is in the frame of the table link.
/// Result:  X, Y and Z changed, all others as given; empty if X, Y and Z of the machine do not span
///          space.
std::optional<AxisValues> reach_tip(const Machine& machine, const AxisValues& values,
                                    const Vec3& tip, double tool_length);

/// The position of the tool tip. Frame: the table link.
Vec3 tip_position(const Machine& machine, const AxisValues& values, double tool_length);

/// The sum of the rotations of all rotary axes between two positions, radians.
double turn_of(const Machine& machine, const AxisValues& from, const AxisValues& to);

/// An upper bound of the distance of the tool tip from any rotary axis, for all angles of the
/// rotary axes, while the tip is at this point. Frame: the table link.
double tip_reach(const Machine& machine, const Vec3& tip, double tool_length);

/// How one mounted body moves relative to another over a leg: with constant orientation, its origin
/// moves straight from position to position (or anywhere in their hull). Every point may be `error`
/// away from that motion; of a body of revolution, every point of the body as a set. Frame: the
/// target's.
struct RelativeLeg {
    Mat3 orientation = Mat3(1.0);
    std::vector<Vec3> positions; // of the mover's origin
    double error = 0.0;          // of the path and of rotation, mm; infinite beyond half a radian
    double lasting_error = 0.0;  // the part of `error` that is the same for any part of the leg
    double deviation = 0.0;      // the part of that by which bodies of CAD files deviate
    double travel = 0.0;         // no point gets farther from where it starts, mm; of a body of
                                 // revolution, as a set
    bool turns = false;          // the orientation is that of the middle of the leg

    /// What shorter legs reduce, mm.
    double reducible_error() const { return error - lasting_error; }
    /// What is due to the motion and not to the bodies of CAD files, mm.
    double error_without_deviation() const { return error - deviation; }
};

/// A mounted body. No point of it is farther from `centre` (in its own frame) than `reach`.
struct Mover {
    Mount mount;
    Vec3 centre = Vec3(0.0);
    double reach = 0.0;
    double form_error = 0.0; // of its shape; added to the errors of its legs
    double deviation = 0.0;  // the part of it that is the deviation of a CAD file
    Play play = {};          // in its own frame
    // A body of revolution about the Z axis of its frame, on which `centre` is: turning about this
    // axis does not change it.
    bool is_revolved = false;
    // Of a convex body of revolution: while it tilts about `centre`, its surface moves along its
    // own normal by at most the angle times this; not known if infinite.
    double arm = infinity;
    // Its ends are within a larger body, which extends over them by at least this, mm. The normals
    // of these ends are not counted in `arm`. 0: there are no such ends.
    double overlap = 0.0;
};

/// Adds displacements to the motion of a body: its origin may be displaced by any vector of the
/// segment. Frame: the target's.
void add_play(RelativeLeg& leg, const Play& play);

/// Adds displacements as an error of the path: half of the segment's length, from its middle.
void add_play_as_error(RelativeLeg& leg, const Play& play);

/// The leg as seen from the target.
///
/// Proof:   core/sim/README.md, "Turning".
RelativeLeg relative_leg(const Machine& machine, const Mount& target, const Mover& mover,
                         const Leg& leg);

/// A bound of how far a body may be, relative to a target, from where the machine has it as stated,
/// anywhere on a leg, because its axes of rotation are only known with tolerances. mm. 0 while
/// these axes are at 0.
///
/// Proof:   core/sim/README.md, "Axes of rotation with tolerances".
double axis_tolerance_error(const Machine& machine, LinkId target, const Mover& mover,
                            const Leg& leg);

/// The rotary axis values that point the tool in a direction.
///
/// Frame:   `tool_axis`, from the tip up, is in the frame of the table link.
/// Result:  of all solutions within the limits the one with the least rotation from `values`; empty
///          if the rotary axes cannot reach the direction.
std::optional<AxisValues> point_tool(const Machine& machine, const AxisValues& values,
                                     const Vec3& tool_axis);

/// All solutions of point_tool within the limits, that with the least rotation first. Whole turns,
/// and turns about the tool itself, make no others.
std::vector<AxisValues> ways_to_point_tool(const Machine& machine, const AxisValues& values,
                                           const Vec3& tool_axis);

/// The rotary axis that tilts the tool or the work out of Z: of several, that of the table which is
/// nearest to the base, or else that of the spindle which is nearest to the tool. Empty if no axis
/// does.
std::optional<size_t> tilting_axis(const Machine& machine);

/// The rotary axis that carries the table directly; empty if none does.
std::optional<size_t> axis_next_to_work(const Machine& machine);

/// The axes of the tool, as columns, in the frame of the table link: X and Y are those of the
/// machine, turned with the head.
Mat3 tool_frame(const Machine& machine, const AxisValues& values);

} // namespace core

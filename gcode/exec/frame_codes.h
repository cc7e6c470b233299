#pragma once

#include <functional>
#include <string>

#include "core/base/result.h"
#include "gcode/exec/execution.h"

namespace gcode {

/// Activates transforms at the current position and emits the offsets if they change.
void use_transforms(Execution& execution, const ProgramTransforms& transforms);

/// Stores the polar words of a motion under G16 in the state.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Polar coordinate command (G15, G16)": a radius
///         given under G90 is measured from the program zero, under G91 from the tool; an angle
///         under G91 is added to the previous one.
core::Result<void> read_polar_words(Execution& execution);

/// Replaces the target in the plane by the position with the radius and angle of G16.
void place_by_radius_and_angle(const Execution& execution, Position& target);

/// Checks that scaling leaves an arc an arc. Errors: unsupported if not.
core::Result<void> check_arc_in_frame(const Execution& execution, const PlaneAxes& axes);

/// G68.2, by Euler angles or (P1) by roll, pitch and yaw.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Tilted working plane command".
core::Result<void> set_tilted_plane(Execution& execution);

/// G53.1: turns the rotary axes until the tool is normal to the tilted plane, if the machine is
/// known.
///
/// Errors: invalid_value without a tilted plane, or if the rotary axes cannot reach it within their
///         limits.
core::Result<void> turn_tool_to_plane(Execution& execution);

/// The values of a position; 0 where it is unknown.
AxisValues values_or_zero(const Position& position);

/// Whether the tool is along Z of the machine; false if an axis that turns it is unknown.
bool is_upright(const core::Machine& machine, const Position& position);

/// Whether a rotary axis has another position.
bool turns_between(const Position& from, const Position& to);

/// The first rotary axis of the machine that has an offset; empty if none has one.
std::optional<size_t> axis_with_rotary_offset(const Offsets& offsets);

/// Difference between the machine's and the program's value of a rotary axis.
double rotary_offset(const Offsets& offsets, size_t axis);

/// The program position after the rotary axes have turned to these machine values while X, Y and Z
/// stay where they are on the machine.
Position turned_in_place(const Offsets& offsets, const Position& program, const AxisValues& to);
Position turned_in_place(const Offsets& offsets, const Position& program, const Position& to);

/// The axes of the tool, as columns, in work coordinates: X and Y are those of the machine, turned
/// with the head. Only with a machine.
///
/// Errors: `what`, the words of the statement, that the position of a rotary axis is unknown.
core::Result<core::Mat3> tool_axes_in_work(const Execution& execution, core::SourceSpan where,
                                           const std::string& what);

/// A direction of the program coordinates in the frame of the table.
core::Vec3 direction_in_table(const Offsets& offsets, const core::Vec3& direction);

/// Turns the rotary axes to machine values by one motion, which `go` makes to a program position,
/// while a point on the axis of the tool stays on the work: that `below` the tip, mm.
void turn_about_tip(Execution& execution, const AxisValues& to, double below,
                    const std::function<void(const Position&)>& go);

/// The angle between the tool and Z of the program coordinates, radians, with the rotary axes where
/// they are.
core::Result<double> angle_to_plane(const Execution& execution, core::SourceSpan where,
                                    const std::string& what);

/// The machine axis values at which the tool is along Z of the program coordinates; linear axes as
/// they are. `sign` is that of the tilting axis (core::tilting_axis), 0 if any will do: then the
/// least rotation counts, and a note says so if there are several solutions. Only with a machine.
///
/// Errors: `what`, the words of the statement, that the position of a rotary axis is unknown, or
///         that none of the positions within the limits will do; another sign will if
///         `may_be_other`.
core::Result<AxisValues> axes_along_z(Execution& execution, core::SourceSpan where,
                                      const std::string& what, int sign, bool may_be_other = false);

/// A plane by two projected angles: X of the coordinates turns about Y, and Y about X, and both
/// then lie in the plane; its X is the first of them. Empty if they are parallel. Degrees.
std::optional<core::Mat3> plane_by_projections(double about_y, double about_x);

/// Controls differ in what they do with an axis that turns the work about the tool when a plane is
/// level. Errors: unsupported if such an axis is away from 0, or (`also_turned`) the plane is
/// turned about the tool.
core::Result<void> check_free_axis(const Execution& execution, const core::Mat3& plane,
                                   core::SourceSpan where, const std::string& what,
                                   bool also_turned);

/// The letters of the words for the direction of the tool (A3, B3, C3; TX, TY, TZ), for the
/// normal of a surface (NX, NY, NZ) and for angles of the direction (A2, B2, C2).
constexpr std::string_view direction_letters = "tuv", normal_letters = "lmn", angle_letters = "wxy";

/// The vector whose components are words with these letters. Words that are left out are 0. Empty
/// if the block has none of them.
std::optional<ToolDirection> vector_words(const Block& block, std::string_view letters);

/// I, J and K under G43.5; A3, B3 and C3 of Siemens, and TX, TY and TZ of Heidenhain, or else NX,
/// NY and NZ, or angles, under tool centre point control. Words that are left out are 0. Empty if
/// the block has none of them.
std::optional<ToolDirection> tool_direction(const Execution& execution);

/// Sets the rotary axes of a target from the direction of the tool.
///
/// Errors: as turn_tool_to_plane; a zero direction.
core::Result<void> point_by_vector(const Execution& execution, Position& target);

/// Whether a dynamic work offset (G254) is on.
bool has_dynamic_offset(const ProgramTransforms& transforms);

/// The sine of the angle to a pole within which the control may turn the tool otherwise than evenly
/// in a plane.
double sine_of_pole_limit(const Execution& execution);

/// Errors: invalid_value if a dynamic work offset is on, which excludes this code.
core::Result<void> check_dynamic_offset_is_off(const Execution& execution, const CodeWord& entry);

/// Whether a code of the block turns the rotary axes to the tilted plane: G53.1, G53.6, G253.
bool turns_to_plane(const Execution& execution);

/// After a block: whether a dynamic work offset (G254) is still as it was set.
///
/// Errors: unsupported if a rotary axis or a work offset has changed.
core::Result<void> check_dynamic_offset(const Execution& execution, const ModalState& before);

/// After a block: whether it continues the blocks of G68.2 P2 or P3 if these are not complete.
///
/// Errors: invalid_value.
core::Result<void> check_plane_is_complete(const Execution& execution, const ModalState& before);

/// The axis of the plane that the first absolute motion after G68 does not name. It keeps the
/// program coordinate it had before G68.
///
/// Source: Fanuc 30i parameter manual B-63950EN, No. 11600#5, as delivered.
std::optional<size_t> axis_left_out_of_rotation(const Execution& execution);

void warn_of_axis_left_out(Execution& execution);

/// To be called after a move in the plane: program and machine agree on the position again.
void forget_position_before_rotation(Execution& execution);

} // namespace gcode

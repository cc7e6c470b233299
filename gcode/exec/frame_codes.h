#pragma once

#include "core/base/result.h"
#include "gcode/exec/execution.h"

namespace gcode {

/// Activates transforms at the current position and emits the change, if any.
void use_transforms(Execution& execution, const ProgramTransforms& transforms);

/// Takes the words of a motion under G16 into the state; nothing else.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Polar coordinate command (G15, G16)": a radius
///         given under G90 counts from the program's zero, under G91 from where the tool is; an
///         angle under G91 adds to the one before.
core::Result<void> take_polar_words(Execution& execution);

/// The target in the plane given by radius and angle of G16.
void place_by_radius_and_angle(const Execution& execution, Position& target);

/// Errors: unsupported for an arc that is scaled to something else than an arc.
core::Result<void> check_arc_in_frame(const Execution& execution, const PlaneAxes& axes);

/// G68.2, by Euler angles or (P1) by roll, pitch and yaw.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Tilted working plane command".
core::Result<void> set_tilted_plane(Execution& execution);

/// G53.1: turns the rotary axes until the tool is normal to the tilted plane, if the machine is
/// known.
///
/// Errors: invalid_value without a plane, and for one to which no rotary axes can turn the tool
///         within their limits.
core::Result<void> turn_tool_to_plane(Execution& execution);

/// Under G43.5, the rotary axes of a target by the direction of the tool in I, J and K.
///
/// Errors: as turn_tool_to_plane, and a direction of no length.
core::Result<void> point_by_vector(const Execution& execution, Position& target);

/// The axis of the plane that the first absolute motion after G68 does not name. Its coordinate is
/// what the program called it before.
///
/// Source: Fanuc 30i parameter manual B-63950EN, No. 11600#5, as delivered.
std::optional<size_t> axis_left_out_of_rotation(const Execution& execution);

void warn_of_axis_left_out(Execution& execution);

/// Called after a move in the plane: program and machine agree on the position again.
void forget_place_before_rotation(Execution& execution);

} // namespace gcode

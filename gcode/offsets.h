#pragma once

#include "core/base/transform.h"
#include "core/sim/kinematics.h"
#include "gcode/axes.h"

namespace gcode {

/// G54 to G59, G59.1 to G59.3; behind them the numbered ones, G54.1 P1 and on.
constexpr size_t plain_offset_count = 9;
constexpr size_t extended_offset_count = 300;
constexpr size_t work_offset_count = plain_offset_count + extended_offset_count;
constexpr size_t no_work_offset = work_offset_count; // Siemens: G500

/// The origin of a work offset in machine coordinates, and how far it is turned about Z.
struct WorkOffset {
    AxisValues origin{};
    double rotation_deg = 0.0;

    bool operator==(const WorkOffset&) const = default;
};

/// What a program does to its coordinates by itself: scaling, mirror images, rotations, tilted
/// planes. Maps the coordinates of the program to those of the work offset.
struct ProgramFrame {
    core::Mat3 linear = core::Mat3(1.0);
    core::Vec3 shift = core::Vec3(0.0);
    bool tilts_tool = false; // the tool is meant to leave the direction of Z

    bool operator==(const ProgramFrame&) const = default;
};

/// Everything that stands between program and machine coordinates, as it is in effect:
/// machine = work + turned(frame(program) + axis + local) + tool.
struct Offsets {
    size_t active = 0; // 0 is G54
    WorkOffset work;
    AxisValues local{};            // G52
    Position axis = zero_position; // G92; empty when set from an unknown place
    AxisValues tool{};             // length along Z, and along the other axes
    ProgramFrame frame;
    bool has_frame = false;    // whether `frame` is more than the identity
    bool tilted_plane = false; // G68.2
    bool follows_tip = false;  // G43.4, G43.5: the tip goes straight, seen from the work
    const core::Machine* machine = nullptr; // where the rotary axes are known; outlives all states

    bool operator==(const Offsets&) const = default;
};

/// Whether coordinates are those of the work as it is turned by the rotary axes, and the tool's
/// length counts along the tool.
inline bool is_fixed_to_work(const Offsets& offsets) {
    return offsets.machine && (offsets.follows_tip || offsets.tilted_plane);
}

/// Whether a coordinate of the machine depends on more than one of the program.
inline bool mixes_axes(const Offsets& offsets) {
    return offsets.has_frame || offsets.work.rotation_deg != 0.0 || is_fixed_to_work(offsets);
}

/// Where the tip stands, in the frame of the table's link; the coordinates of work offsets, mm.
core::Vec3 table_from_work(const Offsets& offsets, const core::Vec3& work);

/// What to add to program coordinates to reach machine coordinates of the gauge line, where nothing
/// is turned.
Position machine_minus_program(const Offsets& offsets);

Position machine_from_program(const Offsets& offsets, const Position& program);
Position program_from_machine(const Offsets& offsets, const Position& machine);

/// The offsets that G28, G30 and G53 count: what a tool is offset by along rotary axes does not
/// shift where these go.
Offsets without_rotary_tool(Offsets offsets);

} // namespace gcode

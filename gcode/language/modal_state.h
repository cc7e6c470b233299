#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/motion/event.h"
#include "gcode/language/code_number.h"

namespace core {
struct Machine;
} // namespace core

namespace gcode {

using core::axis_count;
using core::axis_letters;
using core::AxisValues;
using core::is_rotary;
using core::is_secondary;

/// Axis values in mm and degrees; empty where unknown.
using Position = core::AxisPosition;

constexpr Position zero_position = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};

/// G54 to G59, G59.1 to G59.3; the numbered ones from G54.1 P1 follow.
constexpr size_t plain_offset_count = 9;
constexpr size_t extended_offset_count = 300;
constexpr size_t work_offset_count = plain_offset_count + extended_offset_count;
constexpr size_t no_work_offset = work_offset_count; // Siemens: G500

/// The origin of a work offset in machine coordinates, and its rotation about Z.
struct WorkOffset {
    AxisValues origin{};
    double rotation_deg = 0.0;

    bool operator==(const WorkOffset&) const = default;
};

/// The coordinate transforms of a program: scaling, mirror images, rotations, tilted planes. Maps
/// program coordinates to those of the work offset.
struct ProgramFrame {
    core::Mat3 linear = core::Mat3(1.0);
    core::Vec3 shift = core::Vec3(0.0);
    bool tilts_tool = false; // the tool axis is no longer along Z

    bool operator==(const ProgramFrame&) const = default;
};

/// All active offsets between program and machine coordinates:
/// machine = work + turned(frame(program) + axis + local) + tool.
struct Offsets {
    size_t active = 0; // 0 is G54
    WorkOffset work;
    AxisValues local{};            // G52
    Position axis = zero_position; // G92; empty if set at an unknown position
    AxisValues tool{};             // length along Z, and along the other axes
    ProgramFrame frame;
    bool has_frame = false;    // `frame` is not the identity
    bool tilted_plane = false; // G68.2
    bool follows_tip = false;  // G43.4, G43.5: the tip moves straight relative to the work
    // With `follows_tip`, as LinuxCNC's kinematics do it: machine coordinates are those of the tip
    // at rotary axes of 0, plus the tool length, and so are the origins of all work offsets.
    bool has_world = false;
    const core::Machine* machine = nullptr; // set if its rotary axes are known; outlives all states

    bool operator==(const Offsets&) const = default;
};

/// Whether coordinates turn with the work on the rotary axes, and the tool length counts along the
/// tool.
inline bool is_fixed_to_work(const Offsets& offsets) {
    return offsets.machine && (offsets.follows_tip || offsets.tilted_plane);
}

/// Whether one machine coordinate depends on several program coordinates.
inline bool mixes_axes(const Offsets& offsets) {
    return offsets.has_frame || offsets.work.rotation_deg != 0.0 || is_fixed_to_work(offsets);
}

/// The offsets with which the control counts machine coordinates (G53, G28, G10 L20): of the tip if
/// it `has_world`, else of the gauge line.
Offsets counted_offsets(Offsets offsets);

/// The tip position in the frame of the table's link, from coordinates of the work offset, mm.
core::Vec3 table_from_work(const Offsets& offsets, const core::Vec3& work);

/// Difference between machine coordinates of the gauge line and program coordinates. Only valid
/// without rotations and frames.
Position machine_minus_program(const Offsets& offsets);

Position machine_from_program(const Offsets& offsets, const Position& program);
Position program_from_machine(const Offsets& offsets, const Position& machine);

/// The offsets that apply to G28, G30 and G53: tool offsets along rotary axes do not shift their
/// targets.
Offsets without_rotary_tool(Offsets offsets);

/// G51: coordinates are scaled about a centre.
struct Scaling {
    core::Vec3 factors = core::Vec3(1.0);
    core::Vec3 centre = core::Vec3(0.0);

    bool operator==(const Scaling&) const = default;
};

/// G51.1: coordinates are mirrored about a point, axis by axis.
struct MirrorImage {
    std::array<bool, 3> axes{};
    core::Vec3 position = core::Vec3(0.0);

    bool operator==(const MirrorImage&) const = default;
};

/// G68: a rotation in the plane with this normal axis.
struct PlaneRotation {
    int normal = 2;
    core::Vec3 centre = core::Vec3(0.0); // already scaled and mirrored
    double degrees = 0.0;
    bool is_reversed = false; // an odd number of axes of the plane is mirrored

    bool operator==(const PlaneRotation&) const = default;
};

/// G68.2: the coordinate system of a tilted plane, in work coordinates.
struct TiltedPlane {
    core::Mat3 axes = core::Mat3(1.0); // its axis directions as columns
    core::Vec3 origin = core::Vec3(0.0);
    // G254 of Haas: the axes are those of the machine, and the origin is where the table has turned
    // it.
    bool follows_table = false;

    bool operator==(const TiltedPlane&) const = default;
};

/// G68.2 and G68.4 with P2 and P3: what the blocks so far state of a plane, in work coordinates or
/// those of the plane that is on.
struct BegunPlane {
    bool by_points = true;                 // P2: three points; otherwise P3: two directions
    bool adds = false;                     // G68.4
    int next = 0;                          // the Q of the next block
    std::array<core::Vec3, 2> points = {}; // P2: the first two; P3: the origin, the X axis

    bool operator==(const BegunPlane&) const = default;
};

/// G16: positions in the plane are given by radius and angle.
struct PolarPositions {
    std::array<double, 2> origin{};
    std::optional<double> radius, angle_deg; // empty until programmed

    bool operator==(const PolarPositions&) const = default;
};

/// The active coordinate transforms of a program.
struct ProgramTransforms {
    std::optional<Scaling> scaling;
    MirrorImage mirror;
    std::optional<PlaneRotation> rotation;
    std::optional<TiltedPlane> tilt;
    std::optional<BegunPlane> begun_plane;
    bool follows_vectors = false; // G43.5: moves specify the tool direction
    std::optional<PolarPositions> polar;
    std::optional<Position> before_rotation; // program coordinates just before G68

    bool operator==(const ProgramTransforms&) const = default;
};

/// The rotation about an axis, 0 for X to 2 for Z; exact at multiples of 90 degrees.
core::Mat3 turned_about(int axis, double degrees);

/// All transforms as one map from program to work coordinates: first the mirror image, then
/// scaling, rotation and tilted plane.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, 6, "Scaling and coordinate system rotation" and
///         "Programmable mirror image": the order, and that a mirror image of one axis of the plane
///         reverses the angle of G68.
ProgramFrame frame_of(const ProgramTransforms& transforms);

/// A position after mirror image and scaling, without rotation and tilt.
core::Vec3 scaled_point(const ProgramTransforms& transforms, const core::Vec3& position);

enum class LengthUnit : uint8_t { inch, mm };                         // G20, G21
enum class DistanceMode : uint8_t { absolute, incremental };          // G90, G91
enum class FeedMode : uint8_t { per_minute, inverse_time, per_turn }; // G94, G93, G95
enum class RetractMode : uint8_t { initial_level, r_level };          // G98, G99
enum class Plane : uint8_t { xy, zx, yz, uv, wu, vw };                // G17 G18 G19, G17.1 ...
enum class PathMode : uint8_t { exact_path, exact_stop, continuous }; // G61, G61.1, G64
enum class Side : uint8_t { none, left, right };                      // G40, G41, G42

/// All conversions from program units to mm happen here.
double to_mm(double programmed, LengthUnit unit);
double from_mm(double length, LengthUnit unit);

/// The axes of a plane, as indices; positive rotation is from the first to the second.
struct PlaneAxes {
    size_t first, second, normal;
};

constexpr PlaneAxes axes_of(Plane plane) {
    constexpr PlaneAxes axes[] = {{0, 1, 2}, {2, 0, 1}, {1, 2, 0}, {6, 7, 8}, {8, 6, 7}, {7, 8, 6}};
    return axes[static_cast<size_t>(plane)];
}

/// The modal words of a canned cycle; lengths in mm.
struct CannedCycle {
    CodeNumber code{};
    std::optional<double> bottom, r;     // Z and R in the XY plane
    std::optional<double> dwell;         // s
    std::optional<double> peck;          // Q
    std::array<double, 3> shift{};       // I, J, K of G76 and G87
    std::optional<double> initial_level; // level before the first of a series of cycles
    bool r_is_incremental = false; // R was programmed with G91: it is relative to the initial level
    bool bottom_is_incremental = false; // Z was programmed with G91: it is relative to R

    bool operator==(const CannedCycle&) const = default;
};

/// A transformation of the control that is not modelled and in which the linear axes follow the
/// rotary ones: TRAORI, M128 and the like, or an unknown M code.
struct Following {
    std::array<char, 16> code{}; // as written, ends with 0
    uint32_t line = 0, source = 0;
    bool may_be_on = false;
    bool is_unknown_code = false;
    bool is_said = false;        // reported for this code
    bool rotary_unknown = false; // G53.1 turned the work by unknown angles
    // The direction of the tool has been programmed on a machine that is not described: when the
    // control does not follow it any more, nobody knows where the axes are.
    bool is_pointed = false;
    bool said_turn = false;   // a rotary axis that turns the other way round was reported
    bool said_pole = false;   // a turn that passes near to a pole was reported
    bool awaits_sync = false; // LinuxCNC: kinematics were switched, and no M66 came yet
    uint8_t unknown_axes = 0; // one bit for each of X, Y and Z whose position is unknown

    bool operator==(const Following&) const = default;
};

// Reasons for which motions are followed only as far as is known, so that they cannot be clear:
// several tools have the called name (from then on); the offset of this cutting edge is not known;
// rapids need not be straight (RTLIOF); the approach to contours is another (KONT); the datum is
// another than that of the set-up (cycle 247); corners of the contour have another shape (DISC).
constexpr uint8_t tool_is_in_doubt = 1, edge_is_in_doubt = 2, rapids_are_in_doubt = 4,
                  approach_is_in_doubt = 8, datum_is_in_doubt = 16, corner_is_in_doubt = 32;

/// How far the control may round corners, besides P and Q of G64, mm; empty: not stated.
struct CornerTolerances {
    std::optional<double> distance;        // between feeds, before and after the corner on the path
    std::optional<double> rapid_tolerance; // between rapids, from the path
    std::optional<double> rapid_distance;  // between rapids, before and after the corner
    bool between_kinds = false;            // corners between a rapid and a feed are rounded, too
    bool rapids_keep_speed = false; // those between rapids as far as speeds demand, if not stated
    bool blends = false;            // tolerances say where the control begins to brake (LinuxCNC)

    bool operator==(const CornerTolerances&) const = default;
};

/// The modal state between two blocks. A plain value: copy it to step back.
///
/// Lengths are stored in mm, regardless of G20/G21. What the program has not defined yet is empty,
/// never zero.
struct ModalState {
    LengthUnit unit = LengthUnit::mm;
    bool unit_said = false;
    std::optional<MotionCode> motion;
    bool motion_cancelled = false;    // `motion` is empty because of G80
    std::optional<CannedCycle> cycle; // if present, takes the axis words
    Plane plane = Plane::xy;
    DistanceMode distance = DistanceMode::absolute;
    bool distance_said = true; // false: as the control was left, and not asked yet
    bool work_said = true;     // likewise, of the work offset
    bool retract_said = true;  // likewise, of G98 and G99
    // False: the next block without G90 and G91 settles whether G91 is still active.
    bool incremental_stays = true;
    DistanceMode arc_distance = DistanceMode::incremental; // G90.1, G91.1
    FeedMode feed_mode = FeedMode::per_minute;
    RetractMode retract = RetractMode::initial_level;
    PathMode path = PathMode::continuous;
    double path_tolerance = 0.0, naive_tolerance = 0.0; // mm, P and Q of G64
    CornerTolerances corner_tolerances;
    Side compensation = Side::none;
    double compensation_radius = 0.0; // mm; negative for the other side
    int turning_orientation = 0;      // of the compensated tool, 1 to 9; 0 for a mill
    bool leaves_contour = false;      // no straight move since G40
    bool diameter_mode = false;       // G7: X words are diameters
    bool surface_speed = false;       // G96
    double fastest_speed = 0.0;       // rev/min, D of G96; 0 without a limit
    bool feed_override = true, speed_override = true, adaptive_feed = false, feed_hold = true;

    Position position; // tool tip, program coordinates
    // Since a probing move: the travel from `position` to the farthest point at which the machine
    // may be instead; 0 where an axis is known.
    AxisValues spread{};
    bool has_probed = false;
    // LinuxCNC has not made the last straight feed yet, to join it with the next one.
    bool holds_feed = false;
    Position home, second_home;              // G28, G30: machine coordinates
    Position suspended_axis = zero_position; // saved by G92.2 for G92.3
    bool axis_offset_on = false;             // G92 or G52 is active, even if zero

    std::optional<double> feed;            // mm/min, mm/rev or 1/min, depending on feed_mode
    LengthUnit feed_unit = LengthUnit::mm; // in which it was programmed
    double speed = 0.0;                    // rev/min, or m/min under G96
    core::SpindleDirection spindle = core::SpindleDirection::stopped;
    bool mist = false, flood = false;

    std::optional<core::ToolNumber> selected_tool; // T
    std::optional<core::ToolNumber> tool; // in the spindle since M6; T0 is an empty spindle
    std::optional<core::OffsetNumber> length_number;
    bool plane_said = false; // by the program, or settled
    // That of a length offset that G28, G30 or G53 may have cancelled for good.
    std::optional<core::OffsetNumber> length_left;
    int radius_number = 0;    // the last D; on controls where it is not modal, that of the last G41
    double length_sign = 0.0; // +1 after G43, -1 after G44, 0 without a length from the table
    Offsets offsets;
    std::optional<Position> way_home; // intermediate point of G28, for G29; machine coordinates
    ProgramTransforms transforms;     // `offsets.frame` is derived from them
    Following following;
    uint8_t doubt = 0; // bits: tool_is_in_doubt ...
    // Under tool centre point control, the tool turns in the plane of its directions at the ends of
    // a straight move; otherwise each rotary axis turns evenly.
    bool turns_in_plane = false;
    int kinematics = 0; // LinuxCNC: the number of the active kinematics, of those it can switch
    // Siemens: how far the position programmed last has moved with the zero offset and the tool
    // length since then. Incremental words may travel it, too.
    AxisValues offset_travel{}, length_travel{};
    // Siemens: direction at the end of the last move in the plane; 0, 0 if unknown.
    std::array<double, 2> direction{};

    /// Whether the active length offset has the number of the tool in the spindle.
    bool length_is_tools() const {
        return length_sign != 0.0 && tool && length_number
               && core::value_of(*length_number) == core::value_of(*tool);
    }
    double cycle_dwell = 0.0; // s, P of the last canned cycle

    bool operator==(const ModalState&) const = default;
};

// Copied at every block.
static_assert(std::is_trivially_copyable_v<ModalState>);

/// Changes the offsets without moving the machine; the program coordinates change instead.
void change_offsets(ModalState& modal, const Offsets& offsets);

} // namespace gcode

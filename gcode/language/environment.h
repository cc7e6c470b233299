#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "gcode/language/modal_state.h"
#include "gcode/language/tables.h"

namespace gcode {

enum class DialectId : uint8_t;

/// A property of a control that its programs do not show but that decides where a tool goes. The
/// meaning of its values is the same for all controls.
enum class ControlQuestion : uint8_t {
    length_change_moves, // a change of the length offset alone moves the axis
    point_is_implied,    // X100 is 100 mm; otherwise 100 least increments
    variables_are_kept,  // variables that the program never sets may hold any value
    locals_are_kept,     // likewise the local ones of the main program
    rapids_are_straight, // all axes of a rapid arrive together
    blocks_are_deleted,  // the switch for block delete is on
    // At the start of the program:
    starts_in_inches,    //
    starts_incremental,  // G91 is active
    starts_with_feed,    // G1 is active
    starts_in_plane,     // 17, 18 or 19
    starts_in_yz,        // G19 is active, where that is another parameter
    starts_without_work, // no work offset is active
    starts_with_offset,  // the work offset that is active; its readings are those of the set-up
    starts_at_r_level,   // G99 is active
    modes_are_initial,   // a reset or M30 has restored the initial G codes
    // Tool offsets:
    length_follows_plane, // they act along the axis normal to the plane
    length_follows_axis,  // they act along the axis that the block of G43 names
    length_is_reloaded,   // G10 acts on the length offset in use
    offset_memory,        // what an offset number holds, an OffsetMemory
    radii_are_entered,    // a size in the table of tool offsets is a radius; otherwise a diameter
    entry_has_corner,     // cutter radius compensation begins and ends with a corner
    contour_look_ahead,   // blocks that are read ahead while it is on
    contour_type_is_yasnac,
    entry_is_upright, // G41, G42 and G40 without a move shift the tool at once
    // Cycles:
    drills_normal_to_plane, // otherwise always along Z
    drills_where_defined,   // a block that defines a cycle drills, also without X and Y
    peck_retract,           // of G73, mm
    peck_clearance,         // of G83: where the rapid ends above the last depth, mm
    peck_lift,              // of G83: the retract above R, mm
    shift_direction, // of G76 and G87 along the first (1) or second axis (2) of the plane, or -1,
                     // -2
    // Frames:
    rotation_adds,    // R of G68 under G91 is relative to the angle before
    rotation_default, // of G68 without R, degrees
    scale_unit,       // of G51 without a decimal point
    scale_default,    // of G51 without a factor
    vertical_axis,    // from which G68.3 computes X: 1 is X, 2 is Y and 3 is Z
    vertical_limit,   // so near to this axis, the tool counts as parallel to it, degrees
    local_is_work,    // G52 is a work offset of its own
    change_moves,     // M6 moves the machine first, where no ini file says it
    scales_z,         // G51 scales Z, too
    is_mirrored,      // axes are mirrored by a setting
    // Others:
    incremental_acts_once, // G91 acts in its block only
    lone_arc_is_straight,  // G2 and G3 without a centre and a radius; otherwise an alarm
    change_takes_waiting,  // M6 takes the tool of an earlier T, not that of its own block
    rotary_rolls_over,     // positions of rotary axes count within a turn
    rotary_follows_sign,   // if so, the sign of the word is the direction; otherwise the short way
    half_turn_is_negative, // the short way of half a turn is the negative direction
    m428_follows_tip,   // LinuxCNC without its ini file: M428 switches to tool centre point control
                        // and M429 back; otherwise the other way round
    p1_is_positive,     // P1 of G53.1 tilts in the positive direction and P2 in the negative one;
                        // otherwise the other way round
    w_has_no_motor,     // of 5axiskins: W moves the tip along the tool; otherwise it is a quill
    increment_is_finer, // the least increment is 0.0001 mm instead of 0.001 mm
    increment_is_coarser, // it is 0.01 mm
    corner_tolerance,     // how far corners are rounded unless the program states it, mm
    arc_tolerance,        // allowed difference between the radii of an arc, mm
    arc_tolerance_inch,   // likewise under G20, inches
    one_way_is_modal,     // G60 belongs to the group of G0
    // Siemens:
    machine_moves_tip,     // machine coordinates are those of the tip; otherwise of the gauge line
    length_keeps_axis,     // the tool length stays along Z in each plane
    change_selects_edge,   // a tool change without D selects the first cutting edge
    increment_has_offset,  // incremental words also travel a change of the zero offset
    increment_has_length,  // incremental words also travel a change of the tool length
    tool_changes_with_t,   // T changes the tool; otherwise M6
    corners_are_met,       // G451 is active at the start; otherwise G450
    orientation_by_code,   // ORIAXES and ORIVECT choose how the tool turns; otherwise ORIMKS and
                           // ORIWKS
    axes_turn_in_plane,    // positions of rotary axes turn the tool in a plane where vectors do
    angles_by_code,        // ORIEULER and ORIRPY choose the meaning of A2, B2 and C2
    angles_are_euler,      // if not: they are Euler angles, otherwise RPY angles
    tool_frame_axes,       // how TOROT turns X and Y about the tool (ToolFrameAxes)
    pole_limit,            // so near to a pole, the tool may turn otherwise, degrees
    frame_survives_traori, // TRAORI and TRAFOOF keep the work offset
    corner_limit,          // of G451: a larger change of direction has an arc, degrees
};

/// How the frame of TOROT is turned about the tool.
enum class ToolFrameAxes : uint8_t {
    of_machine, // X and Y of the machine, turned with the head and as seen from the table
    x_in_zx,    // X stays in the old ZX plane
    y_in_yz,    // Y stays in the old YZ plane
    between,    // half-way between these two
};

/// What each number of a table of tool offsets holds.
enum class OffsetMemory : uint8_t {
    separate,  // C: a length for H and a radius for D, each with its wear
    with_wear, // B: one value with its wear, a length under H and a radius under D
    one_value, // A: one value
};

/// What is known about a control.
struct ControlSettings {
    // As stated in the set-up or by its preset. Yes is 1 and no is 0.
    std::map<ControlQuestion, double> answers{};
    /// Whether the interpreter reports open premises. Otherwise the first value of each parameter
    /// counts, and variables that were never set are empty.
    bool reports_premises = false;
    /// Whether the unit and the plane of a program that states none are among them. Only what is in
    /// the machine can show which they are, so otherwise the usual ones are assumed.
    bool follows_start = false;
    /// Values of variables that the program cannot know, by number: inputs, results of probing.
    std::map<int, double> values{};
    /// Values of global variables that an earlier program may have left, by name without `#<>`, in
    /// lower case; empty: not set.
    std::map<std::string, std::optional<double>, std::less<>> named_values{};

    std::optional<double> number(ControlQuestion question) const {
        const auto found = answers.find(question);
        return found == answers.end() ? std::nullopt : std::optional(found->second);
    }
    std::optional<bool> answer(ControlQuestion question) const {
        const auto stated = number(question);
        return stated ? std::optional(*stated != 0.0) : std::nullopt;
    }
};

/// Limits on the run of a program.
struct Limits {
    uint64_t blocks = 50'000'000;
    size_t calls = 0;                      // 0: the limit of the control
    std::function<bool()> is_stopped = {}; // cancelled by the user; polled from time to time
};

/// What the control does at a tool change before it exchanges the tool, in this order. The machine
/// stays where it ends. Machine coordinates of the gauge line, mm and degrees.
struct ToolChangeMotion {
    bool quill_up = false;              // rapid in Z to machine zero
    bool goes_to_second_home = false;   // rapid of all axes to the reference point of G30
    Position position{};                // rapid to here; axes without a value stay
    bool keeps_spindle_running = false; // otherwise M6 stops the spindle
    bool is_stated = false;             // also that it does nothing
};

/// The kinematics between which a LinuxCNC machine switches, by number; 0 is active at the start.
struct SwitchableKinematics {
    enum class Type : uint8_t {
        axes,  // X, Y and Z are the axes of the machine
        tip,   // they are the tip of the tool, as seen from the work
        other, // not known
    };
    std::string module; // such as xyzac-trt-kins
    std::vector<Type> types;
    std::optional<int> output;                    // the analogue output of M68 that selects one
    std::string coordinates;                      // the letter of each joint
    std::shared_ptr<const core::Machine> machine; // its rotary axes; null: they are not known
};

/// The state of the control before the program starts. Lengths in mm, positions in machine
/// coordinates.
struct Environment {
    DialectId dialect{};                      // LinuxCNC
    bool block_delete = false;                // true: blocks with `/` are skipped
    LengthUnit machine_unit = LengthUnit::mm; // unit of LinuxCNC's offsets and start positions
    bool machine_unit_is_stated = false;
    std::optional<LengthUnit> units_at_start{}; // of the program; empty: not stated
    std::array<AxisValues, plain_offset_count> work_offsets{};
    std::map<size_t, AxisValues> extended_offsets{}; // by index, from plain_offset_count on
    std::map<core::OffsetNumber, LengthOffset> length_offsets{};
    std::map<core::ToolNumber, double> tool_lengths{};   // for H numbers not in the table
    std::set<core::ToolNumber> guessed_lengths{};        // of tool_lengths: nobody stated them
    std::map<core::ToolNumber, double> tool_diameters{}; // for D numbers not in the table
    // The tools that the set-up describes, by name; under "" those without a name.
    std::multimap<std::string, core::ToolNumber> tool_names{};
    Position start{};                        // gauge line; X, Y, Z empty if unknown
    std::optional<AxisValues> home{};        // G28; machine zero if not stated
    std::optional<AxisValues> second_home{}; // G30; likewise
    std::optional<AxisValues> fixed_point{}; // Siemens' G75; machine coordinates
    Position swivel_retract{}; // where CYCLE800 retracts before it swivels; empty: not known
    std::array<std::optional<AxisValues>, 2> further_homes{}; // G30 P3 and P4
    // G60: the last part of its rapid, whose sign is the direction; empty: not known.
    std::optional<AxisValues> one_way_approach{};
    bool measured_offsets_are_stated =
        false; // offsets set at a probed contact are those of the table
    // Heidenhain: the row of the preset table that is the work offset of the set-up.
    std::optional<double> datum{};
    ToolChangeMotion tool_change{};
    bool counts_smallest_steps = false; // X5 is 5 um and X5. is 5 mm, where the point matters
    ControlSettings control{};
    std::map<int, double> parameters{}; // numbered ones, as in a variables file
    std::string startup_code{};         // executed before the first block; sets modes and offsets
    std::string wrapped_axes{}; // letters of rotary axes with absolute positions in one turn, whose
                                // sign is the direction (LinuxCNC's WRAPPED_ROTARY)
    // LinuxCNC's ini file. Values by names such as _ini[traj]x and _hal[motion.switchkins-type];
    // subprograms that run in place of codes such as M428.
    std::map<std::string, double> ini_values{}, hal_values{};
    std::map<std::string, std::string> remaps{};
    std::optional<SwitchableKinematics> kinematics{};
    std::vector<std::string> search_path{}; // folders of subprograms; empty: the program's folder
    std::set<int> known_m_codes{};          // of the machine builder; ignored without a warning
    Limits limits{};
    // Called with each value of a system variable that the program reads: offsets, positions,
    // modes. Empty values are passed as 0.
    std::function<void(double)> on_system_read = {};
    std::shared_ptr<const core::Machine> machine{}; // only if the machine has rotary axes

    /// The origin of a work offset; zero if it is not stated.
    AxisValues work_offset(size_t index) const {
        if (index < plain_offset_count) return work_offsets[index];
        const auto found = extended_offsets.find(index);
        return found == extended_offsets.end() ? AxisValues{} : found->second;
    }
    AxisValues& writable_work_offset(size_t index) {
        return index < plain_offset_count ? work_offsets[index] : extended_offsets[index];
    }
};

} // namespace gcode

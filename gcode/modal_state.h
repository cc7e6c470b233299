#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "core/base/ids.h"
#include "core/sim/event.h"
#include "gcode/offsets.h"
#include "gcode/program_transforms.h"

namespace gcode {

enum class LengthUnit : uint8_t { inch, mm };                         // G20, G21
enum class DistanceMode : uint8_t { absolute, incremental };          // G90, G91
enum class FeedMode : uint8_t { per_minute, inverse_time, per_turn }; // G94, G93, G95
enum class RetractMode : uint8_t { initial_level, r_level };          // G98, G99
enum class Plane : uint8_t { xy, zx, yz, uv, wu, vw };                // G17 G18 G19, G17.1 ...
enum class PathMode : uint8_t { exact_path, exact_stop, continuous }; // G61, G61.1, G64
enum class Side : uint8_t { none, left, right };                      // G40, G41, G42

/// What a block without a motion code goes on with: the code in tenths, 10 for G1, 385 for G38.5.
using MotionCode = int;

/// The only place where program units become mm.
constexpr double to_mm(double programmed, LengthUnit unit) {
    return unit == LengthUnit::inch ? programmed * 25.4 : programmed;
}
constexpr double from_mm(double length, LengthUnit unit) {
    return unit == LengthUnit::inch ? length / 25.4 : length;
}

/// The axes of a plane, as indices: the first two turn about the third.
struct PlaneAxes {
    size_t first, second, normal;
};

constexpr PlaneAxes axes_of(Plane plane) {
    constexpr PlaneAxes axes[] = {{0, 1, 2}, {2, 0, 1}, {1, 2, 0}, {6, 7, 8}, {8, 6, 7}, {7, 8, 6}};
    return axes[static_cast<size_t>(plane)];
}

/// What a canned cycle keeps for the blocks after it; lengths as programmed, in mm.
struct CannedCycle {
    int code = 0;                        // tenths: 810 for G81
    std::optional<double> bottom, r;     // Z and R in the XY plane
    std::optional<double> dwell;         // s
    std::optional<double> peck;          // Q
    std::array<double, 3> shift{};       // I, J, K of G76 and G87
    std::optional<double> initial_level; // where the axis was before the first of the cycles
    bool r_is_way = false;               // R was said under G91: counts from there
    bool bottom_is_way = false;          // Z was said under G91: counts from R

    bool operator==(const CannedCycle&) const = default;
};

/// Everything one block leaves behind for the next. A plain value: copy it to go back in time.
///
/// Lengths are stored in mm whatever G20/G21 says. What the program has not yet defined is empty,
/// never zero.
struct ModalState {
    LengthUnit unit = LengthUnit::mm;
    bool unit_said = false;
    std::optional<MotionCode> motion;
    std::optional<CannedCycle> cycle; // takes the axis words while it is there
    Plane plane = Plane::xy;
    DistanceMode distance = DistanceMode::absolute;
    DistanceMode arc_distance = DistanceMode::incremental; // G90.1, G91.1
    FeedMode feed_mode = FeedMode::per_minute;
    RetractMode retract = RetractMode::initial_level;
    PathMode path = PathMode::continuous;
    double path_tolerance = 0.0, naive_tolerance = 0.0; // mm, P and Q of G64
    Side compensation = Side::none;
    double compensation_radius = 0.0; // mm; below zero it is on the other side
    int turning_orientation = 0;      // of the compensated tool, 1 to 9; 0 is a mill
    bool leaves_contour = false;      // since G40 no straight move was made
    bool diameter_mode = false;       // G7: X words are diameters
    bool surface_speed = false;       // G96
    double fastest_speed = 0.0;       // rev/min, D of G96; 0 without a limit
    bool feed_override = true, speed_override = true, adaptive_feed = false, feed_hold = true;

    Position position;                       // tool tip, program coordinates
    Position home, second_home;              // G28, G30: machine coordinates
    Position suspended_axis = zero_position; // kept by G92.2 for G92.3
    bool axis_offset_on = false;             // G92 or G52 holds, be it zero

    std::optional<double> feed; // mm/min, mm/rev or 1/min, as feed_mode says
    double speed = 0.0;         // rev/min, or m/min under G96
    core::SpindleDirection spindle = core::SpindleDirection::stopped;
    bool mist = false, flood = false;

    std::optional<core::ToolNumber> selected_tool; // T
    std::optional<core::ToolNumber> tool;          // in the spindle since M6; T0 is an empty one
    std::optional<core::OffsetNumber> length_number;
    int radius_number = 0;    // the D said last, where it stays
    double length_sign = 0.0; // +1 since G43, -1 since G44, 0 while no table length is on
    Offsets offsets;
    std::optional<Position> way_home; // where G28 passed, for G29; machine coordinates
    ProgramTransforms transforms;     // `offsets.frame` is made of them
    // Siemens: in which the last motion of the plane ended; 0, 0 when that is not known.
    std::array<double, 2> direction{};

    /// Whether the length offset that is on is that of the tool in the spindle.
    bool length_is_tools() const {
        return length_sign != 0.0 && tool && length_number
               && core::value_of(*length_number) == core::value_of(*tool);
    }
    double cycle_dwell = 0.0; // s, P of the last canned cycle

    bool operator==(const ModalState&) const = default;
};

// It is copied at every block.
static_assert(std::is_trivially_copyable_v<ModalState>);

} // namespace gcode

#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/sim/event.h"
#include "gcode/offsets.h"

namespace gcode {

enum class LengthUnit : uint8_t { inch, mm };                         // G20, G21
enum class DistanceMode : uint8_t { absolute, incremental };          // G90, G91
enum class FeedMode : uint8_t { per_minute, inverse_time, per_turn }; // G94, G93, G95
enum class RetractMode : uint8_t { initial_level, r_level };          // G98, G99
enum class Plane : uint8_t { xy, zx, yz };                            // G17, G18, G19
enum class MotionMode : uint8_t { traverse, feed, arc_clockwise, arc_counterclockwise }; // G0-G3

/// The only place where program units become mm.
constexpr double to_mm(double programmed, LengthUnit unit) {
    return unit == LengthUnit::inch ? programmed * 25.4 : programmed;
}

/// The axes of a plane: the first two turn about the third, 0 X, 1 Y, 2 Z.
struct PlaneAxes {
    int first, second, normal;
};

constexpr PlaneAxes axes_of(Plane plane) {
    if (plane == Plane::xy) return {0, 1, 2};
    if (plane == Plane::zx) return {2, 0, 1};
    return {1, 2, 0};
}

/// What a canned cycle keeps for the blocks after it; lengths as programmed, in mm.
struct CannedCycle {
    int code = 0;                        // tenths: 810 for G81
    std::optional<double> bottom, r;     // Z and R in the XY plane
    std::optional<double> dwell;         // s
    std::optional<double> peck;          // Q
    std::optional<double> initial_level; // where the axis was before the first of the cycles

    bool operator==(const CannedCycle&) const = default;
};

/// Everything one block leaves behind for the next. A plain value: copy it to go back in time.
///
/// Lengths are stored in mm whatever G20/G21 says. What the program has not yet defined is empty,
/// never zero.
struct ModalState {
    LengthUnit unit = LengthUnit::mm;
    bool unit_said = false;
    std::optional<MotionMode> motion;
    std::optional<CannedCycle> cycle; // takes the axis words while it is there
    Plane plane = Plane::xy;
    DistanceMode distance = DistanceMode::absolute;
    DistanceMode arc_distance = DistanceMode::incremental; // G90.1, G91.1
    FeedMode feed_mode = FeedMode::per_minute;
    RetractMode retract = RetractMode::initial_level;

    Position position;                 // tool tip, program coordinates
    std::array<double, 3> rotary = {}; // A, B, C in degrees; nothing turns them yet
    Position home, second_home;        // G28, G30: machine coordinates

    std::optional<double> feed; // mm/min, mm/rev or 1/min, as feed_mode says
    double speed = 0.0;         // rev/min
    core::SpindleDirection spindle = core::SpindleDirection::stopped;
    bool mist = false, flood = false;

    std::optional<core::ToolNumber> selected_tool; // T
    std::optional<core::ToolNumber> tool;          // in the spindle since M6; T0 is an empty one
    std::optional<core::OffsetNumber> length_number;
    double length_sign = 0.0; // +1 since G43, -1 since G44, 0 while no table length is on
    Offsets offsets;

    bool operator==(const ModalState&) const = default;
};

} // namespace gcode

#pragma once

#include <array>
#include <optional>

#include "core/sim/event.h"

namespace gcode {

/// mm, axis by axis; empty where nobody knows.
using Position = core::AxisPosition;

constexpr Position zero_position = {0.0, 0.0, 0.0};

/// G54 to G59, G59.1 to G59.3.
constexpr size_t work_offset_count = 9;

/// Everything that stands between program and machine coordinates.
struct Offsets {
    std::array<core::Vec3, work_offset_count> work{}; // origins in machine coordinates
    size_t active = 0;                                // index into `work`
    core::Vec3 local = core::Vec3(0.0);               // G52
    Position axis = zero_position;                    // G92; empty when set from an unknown place
    Position suspended_axis = zero_position;          // kept by G92.2 for G92.3
    double tool_length = 0.0;                         // along Z

    bool operator==(const Offsets&) const = default;
};

/// What to add to program coordinates to reach machine coordinates of the gauge line.
Position machine_minus_program(const Offsets& offsets);

Position machine_from_program(const Offsets& offsets, const Position& program);
Position program_from_machine(const Offsets& offsets, const Position& machine);

} // namespace gcode

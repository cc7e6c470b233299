#pragma once

#include <array>
#include <map>
#include <optional>

#include "core/base/ids.h"
#include "gcode/dialect.h"
#include "gcode/offsets.h"

namespace gcode {

/// An entry of the control's offset table.
struct LengthOffset {
    double length = 0.0;   // mm
    double wear = 0.0;     // mm, added to the length
    double diameter = 0.0; // mm

    bool operator==(const LengthOffset&) const = default;
};

/// What the control holds before the program starts. Lengths in mm, places in machine coordinates.
struct Environment {
    DialectId dialect = DialectId::linuxcnc;
    bool block_delete = false; // true: blocks with `/` are left out
    std::array<core::Vec3, work_offset_count> work_offsets{};
    std::map<core::OffsetNumber, LengthOffset> length_offsets{};
    std::map<core::ToolNumber, double> tool_lengths{}; // for H numbers without an entry
    Position start{};                                  // gauge line; empty where nobody knows
    std::optional<core::Vec3> home{};                  // G28; machine zero when nobody says
    std::optional<core::Vec3> second_home{};           // G30; likewise
};

} // namespace gcode

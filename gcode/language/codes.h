#pragma once

#include <cstdint>
#include <string_view>

#include "gcode/language/dialect.h"

namespace gcode {

/// Codes of one group replace each other; a block may contain one code of each group.
enum class ModalGroup : uint8_t {
    action, // one-shot codes: G4, G10, G28, G52, G53, G92
    motion,
    cycle,
    plane,
    units,
    distance,
    arc_distance,
    feed_mode,
    retract,
    cutter_radius,
    tool_length,
    work_offset,
    path_control,
    exact_stop,
    spindle_mode,
    scaling,
    rotation,
    polar,
    mirror,
    macro,
    other,
    stopping,
    tool_change,
    spindle,
    coolant,
    overrides,
    subprogram,
    diameter,
    count
};

/// Dialects as a set of bits, 1 << id.
using DialectSet = uint8_t;

/// One G or M code.
struct Code {
    char letter;
    int tenths; // 593 for G59.3
    ModalGroup group;
    std::string_view words;   // used besides F, S and T; "XYZ" means all axes
    DialectSet dialects;      // that have this code
    std::string_view refusal; // why it is not supported; empty if it is supported
    int last = 0;             // for a range of codes with one row, the last code, in tenths

    bool uses(char word) const { return words.find(word) != std::string_view::npos; }
    MotionCode motion() const { return static_cast<MotionCode>(tenths); }
    constexpr int last_tenths() const { return last ? last : tenths; }
    bool uses_axes() const { return words.starts_with("XYZ"); }
};

/// The number of a code in tenths; tenths(59, 3) is G59.3.
constexpr int tenths(int whole, int tenth = 0) { return whole * 10 + tenth; }

/// The code of a word such as G59.3 or M6 in a dialect; null when the dialect has no such code.
const Code* find_code(char letter, double value, DialectId dialect);

} // namespace gcode

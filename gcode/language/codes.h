#pragma once

#include <cstdint>
#include <string_view>

#include "gcode/language/code_number.h"
#include "gcode/language/dialect.h"

namespace gcode {

/// Why the codes and keywords of smooth approach and retract are refused.
inline constexpr std::string_view no_smooth_approach =
    "smooth approach and retract are not supported yet: program the moves with G1 and G2 or G3";

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

/// Dialects as a set of bits, 1 << Dialect::codes.
using DialectSet = uint16_t;

/// One G or M code.
struct Code {
    CodeNumber number;
    ModalGroup group;
    std::string_view words;           // used besides F, S and T; "XYZ" means all axes
    DialectSet dialects;              // that have this code
    std::string_view refusal;         // why it is not supported; empty if it is supported
    std::optional<CodeNumber> last{}; // for a range of codes with one row, the last code

    bool uses(char word) const { return words.find(word) != std::string_view::npos; }
    constexpr CodeNumber last_number() const { return last.value_or(number); }
    bool uses_axes() const { return words.starts_with("XYZ"); }
    bool is_cycle() const { return group == ModalGroup::cycle && number != g_code(80); }
};

/// Whether the moves of a block with this code are in machine coordinates: G53, and G153 of
/// Siemens. SUPA is read as G53.
constexpr bool is_machine_move(CodeNumber code) {
    return code == g_code(53) || code == g_code(153);
}

/// The code of a number in a dialect, or null when the dialect has none.
const Code* find_code(CodeNumber number, DialectId dialect);

/// The code of a word such as G59.3 or M6 in a dialect; null when the dialect has no such code.
const Code* find_code(char letter, double value, DialectId dialect);

} // namespace gcode

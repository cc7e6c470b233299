#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace gcode {
struct Dialect;
struct Environment;
struct InterpreterState;
} // namespace gcode

namespace app {

/// A value of the control or the machine for display: a number in the units of messages (mm,
/// degrees, mm/min, rev/min, s) or a word.
struct InspectedValue {
    std::optional<double> number; // empty: a word, or unknown
    std::string text;             // "12.5 mm", "G2", "unknown"
    std::string meaning = {};     // of a code: "arc clockwise" for G2

    bool operator==(const InspectedValue&) const = default;
};

/// Whether the text or the meaning of a value is this word, ignoring case.
bool is_word(const InspectedValue& value, std::string_view word);

/// The value of an expression in a state of the control: `#100`, `#<_name>`, `R5` (Siemens), `Q5`
/// (Heidenhain), `$AA_IM[X]` and declared names (Siemens), as a program would read them; modal
/// values with the names of modal_values; x y z a b c u v w (tool tip, program coordinates),
/// machine.x ...; G54.x ... (origins), G54, G52.x, G92.x; H3 (length offset), D3 (tool diameter).
/// Case is ignored.
///
/// Units:  lengths in mm; numbered and named parameters in the units of the program.
/// Errors: invalid_value for any other name, with the nearest known one.
core::Result<InspectedValue> value_of(const std::string& expression,
                                      const gcode::InterpreterState& control,
                                      const gcode::Environment& environment);

/// Whether an expression has a form that value_of accepts. False for names declared by a program,
/// which depend on its state.
bool names_value(const std::string& expression);

struct NamedValue {
    std::string name;
    InspectedValue value;

    bool operator==(const NamedValue&) const = default;
};

/// Every modal value with its name, the most useful first.
std::vector<NamedValue> modal_values(const gcode::InterpreterState& control,
                                     const gcode::Environment& environment);
/// The known axis positions: x y z ... and machine.x ...
std::vector<NamedValue> axis_values(const gcode::InterpreterState& control);
/// Numbered and named parameters that have a value: local ones of the current level, and global
/// ones.
std::vector<NamedValue> parameter_values(const gcode::InterpreterState& control,
                                         const gcode::Environment& environment);
/// Work offsets that are nonzero or active, those of G52 and G92, and the length table.
std::vector<NamedValue> offset_values(const gcode::InterpreterState& control);

/// The names of value_of that begin with a text, for completion.
std::vector<std::string> names_beginning(const std::string& text);

enum class ModalKind : uint8_t { number, word };

/// A modal value by its name.
struct ModalEntry {
    std::string_view name;
    ModalKind kind;
    std::string_view words; // the possible words, comma-separated; empty: too many to list
    InspectedValue (*read)(const gcode::InterpreterState& control, const gcode::Dialect& dialect);
};

/// All modal values, the most useful first.
std::span<const ModalEntry> modal_table();

/// The entry with this name; null: none.
const ModalEntry* modal_entry(std::string_view name);

/// The possible words of an entry.
std::vector<std::string> words_of(const ModalEntry& entry);

/// The name of a work offset: "G54", "G59.1", "G54.1P3", "G500".
std::string offset_name(size_t index);

/// The index of an offset by its name in upper case; empty: no such offset.
std::optional<size_t> offset_named(std::string_view name);

/// A number with at most four decimals, without trailing zeros; never "-0".
std::string number_text(double value);

/// A value with its unit: "12.5 mm"; "unknown" without a value.
InspectedValue quantity(std::optional<double> value, std::string_view unit = {});

/// As quantity, in degrees for rotary axes, else in mm.
InspectedValue axis_quantity(size_t axis, std::optional<double> value);

} // namespace app

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

/// A value of the control or the machine, as a report says it: a number in the units of messages
/// (mm, degrees, mm/min, rev/min, s) or a word.
struct InspectedValue {
    std::optional<double> number; // empty: a word, or nobody knows
    std::string text;             // "12.5 mm", "G2", "unknown"
    std::string meaning = {};     // of a code: "arc, clockwise" of G2

    bool operator==(const InspectedValue&) const = default;
};

/// Whether a value is this word: its text or its meaning, whatever the case of the letters.
bool is_word(const InspectedValue& value, std::string_view word);

/// The value of an expression in the state of a control: `#100`, `#<_name>`, `R5` (Siemens), `Q5`
/// (Heidenhain), `$AA_IM[X]` and declared names (Siemens), as a program would read them; the modal
/// values by the names that modal_values gives; x y z a b c u v w (the tip, program coordinates),
/// machine.x ...; G54.x ... (origins), G54, G52.x, G92.x; H3 (the length in the table), D3 (the
/// diameter). The case of letters does not matter.
///
/// Units:  lengths in mm; numbered and named parameters as the program has them.
/// Errors: invalid_value, with the nearest name, when it is none of these.
core::Result<InspectedValue> value_of(const std::string& expression,
                                      const gcode::InterpreterState& control,
                                      const gcode::Environment& environment);

/// Whether it is written like something that value_of may know. A name that a program declares
/// only its state knows.
bool names_value(const std::string& expression);

struct NamedValue {
    std::string name;
    InspectedValue value;

    bool operator==(const NamedValue&) const = default;
};

/// Every modal value with its name, in the order in which a person asks for them.
std::vector<NamedValue> modal_values(const gcode::InterpreterState& control,
                                     const gcode::Environment& environment);
/// Where the axes stand that anything is known of: x y z ... and machine.x ...
std::vector<NamedValue> axis_values(const gcode::InterpreterState& control);
/// Numbered and named parameters that hold something, of the innermost level and the common ones.
std::vector<NamedValue> parameter_values(const gcode::InterpreterState& control,
                                         const gcode::Environment& environment);
/// Work offsets that hold something or are on, those of G52 and G92, and the length table.
std::vector<NamedValue> offset_values(const gcode::InterpreterState& control);

/// The names that value_of knows and that begin so, for completion.
std::vector<std::string> names_beginning(const std::string& text);

enum class ModalKind : uint8_t { number, word };

/// A modal value by its name.
struct ModalEntry {
    std::string_view name;
    ModalKind kind;
    std::string_view words; // all that a word may be, with commas; empty: too many to list
    InspectedValue (*read)(const gcode::InterpreterState& control, const gcode::Dialect& dialect);
};

/// All of them, in the order in which a person asks.
std::span<const ModalEntry> modal_table();

/// The entry of that name; null when there is none.
const ModalEntry* modal_entry(std::string_view name);

/// The words that an entry's value may be.
std::vector<std::string> words_of(const ModalEntry& entry);

/// "G54", "G59.1", "G54.1P3", "G500".
std::string offset_name(size_t index);

/// The index of that name, in capitals; empty when it names none.
std::optional<size_t> offset_named(std::string_view name);

/// At most four decimals, without zeros behind the last one that counts; never "-0".
std::string number_text(double value);

/// "12.5 mm"; "unknown" where nobody knows.
InspectedValue quantity(std::optional<double> value, std::string_view unit = {});

/// Degrees along rotary axes, else mm.
InspectedValue axis_quantity(size_t axis, std::optional<double> value);

/// In small letters.
std::string lowered(std::string_view text);

} // namespace app

#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "gcode/language/modal_state.h"

namespace app {

struct ControlOffsets;
struct SetupFile;
struct UsedOffsets;

/// How a value of the set-up and that of the control relate.
enum class OffsetState : uint8_t { equal, differs, not_in_setup, not_on_control };
std::string_view name_of(OffsetState state);

/// One value of the set-up and the control's.
struct ComparedOffset {
    std::string name;                     // "G54 X", "H3", "D3"
    bool is_angle = false;                // degrees instead of mm
    std::optional<double> setup, control; // empty: not stated
    std::string file{};                   // that states the control's value; empty: none
    uint32_t line = 0;
    OffsetState state = OffsetState::equal;
    std::string work_offset{}; // "G54", whose axis this is; empty: another value
    size_t axis = 0;           // of the work offset, as in core::axis_letters
};

/// A set-up compared with the files of a control.
struct OffsetComparison {
    gcode::LengthUnit unit = gcode::LengthUnit::mm; // of the set-up, for texts; all values are mm
    std::vector<ComparedOffset> values;             // work offsets, then lengths, then diameters
    std::vector<std::string> notes;                 // for the user
    std::set<size_t> used{};                        // work offsets that the program uses, by index
    // Why the program was not read to its end: what it uses after that is not compared.
    std::optional<core::Error> stopped{};

    /// How many of the values are not equal.
    size_t differences() const;
};

/// Whether the set-up, or the variables file that it names, states a work offset; index 0 is G54.
bool states_work_offset(const SetupFile& setup, size_t index);

/// Compares the offsets that the set-up states or the program uses. Values of the control that
/// matter to neither are left out, and so are kinds of values that no file has: a variables file
/// says nothing about lengths.
///
/// Result: equal within half the last digit that controls show: 0.0005 mm or degrees, 0.00005 inch.
OffsetComparison differences(const SetupFile& setup, const ControlOffsets& control,
                             const UsedOffsets& used);

/// A set-up that states the work offsets of the control where they differ from its own.
///
/// Result: the text; as it was if no work offset differs, or if the control states none.
/// Errors: those of toml_with_value.
core::Result<std::string> with_work_offsets(const std::string& text,
                                            const OffsetComparison& comparison);

} // namespace app

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/setup/presets/preset.h"
#include "core/base/result.h"

namespace app {

/// How a machine is built, for lists. The order is that of the lists.
enum class MachineKind : uint8_t {
    router,
    bench_mill,
    knee_mill,
    vertical,
    horizontal,
    trunnion,   // both rotary axes carry the work
    head_table, // one carries the tool, one the work
    head_head   // both carry the tool
};

inline constexpr std::array machine_kinds = {MachineKind::router,     MachineKind::bench_mill,
                                             MachineKind::knee_mill,  MachineKind::vertical,
                                             MachineKind::horizontal, MachineKind::trunnion,
                                             MachineKind::head_table, MachineKind::head_head};

/// "knee-mill".
std::string_view name_of(MachineKind kind);
/// "Knee mills", a heading.
std::string_view title_of(MachineKind kind);

enum class MachineUnit : uint8_t {
    mm,
    mm_per_minute,
    mm_per_second2,
    deg,
    deg_per_minute,
    deg_per_second2
};

/// "mm/min".
std::string_view name_of(MachineUnit unit);
bool is_angle(MachineUnit unit);

/// A size of a machine: a key of `[machine]` beside `preset`.
struct MachineSize {
    std::string_view key;
    MachineUnit unit;
    std::optional<double> standard; // empty: nobody has stated it, so what needs it is left out
    bool is_typical;                // not from the source of the preset
    double least, greatest;
    std::string_view meaning; // in lower case, to follow the key
};

/// A machine by its name, with sizes that can be changed.
struct MachinePreset {
    std::string_view name; // "haas-vf-2"
    MachineKind kind;
    std::string_view title;  // "Haas VF-2"
    std::string_view source; // of its sizes: a sentence
    std::string_view zero;   // where machine zero is: a sentence
    std::string_view taper;  // of its spindle, as in names of holders; or empty
    char tilt, rotary;       // letters of its rotary axes; 0: it has none
    bool is_generic;         // no make: all its sizes are typical
    std::vector<MachineSize> sizes;

    /// Null if it has no size with this key.
    const MachineSize* size(std::string_view key) const;
};

/// All machines, by kind, those of a make first, then by name, with numbers by their values.
std::span<const MachinePreset> machine_presets();

/// Null if there is none of this name.
const MachinePreset* find_machine_preset(std::string_view name);

/// A sentence for a name that no machine has, with the nearest name or where the list is.
std::string unknown_machine_text(std::string_view name);

/// "from 1 to 230 mm".
std::string range_text(const MachineSize& size);

/// Whether a value can be that of a size.
bool fits(const MachineSize& size, double value);

/// Errors: invalid_value: a key that the preset does not have, with the nearest one, or a value
/// that
///         does not fit, with the range.
core::Result<void> check_machine_value(const MachinePreset& preset, std::string_view key,
                                       double value);

/// A machine as a file states it.
struct MachineText {
    std::string toml;               // a machine file, with comments
    std::string others;             // letters of axes that it has and that the file leaves out
    std::vector<std::string> notes; // what is assumed or left out, as clauses
};

/// The machine file of a preset, in mm, with some sizes as stated.
///
/// Bodies and rotary axes are there only if all the sizes that they need are known.
/// Errors: those of check_machine_value; invalid_value: limits that contradict each other, or only
///         some of the sizes of a rotary axis.
core::Result<MachineText> machine_text(const MachinePreset& preset,
                                       const PresetValues& stated = {});

} // namespace app

#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/geom/mesh.h"

namespace app {

/// What a preset is, for lists. The order is that of the lists.
enum class PresetKind : uint8_t { vise, clamp, block, plate, chuck, holder };

/// The kinds of fixtures.
inline constexpr std::array preset_kinds = {PresetKind::vise, PresetKind::clamp, PresetKind::block,
                                            PresetKind::plate, PresetKind::chuck};

/// "vise".
std::string_view name_of(PresetKind kind);
/// "Vises", a heading.
std::string_view title_of(PresetKind kind);

enum class PresetMeasure : uint8_t { length, count };

/// A size of a preset: the key for it in a set-up file. Lengths are mm.
struct PresetParameter {
    std::string_view key;
    double standard; // the value if none is stated
    double least, greatest;
    std::string_view meaning; // in lower case, to follow the key
    PresetMeasure measure = PresetMeasure::length;
};

/// Values of parameters by their keys, mm or counts. What is absent has the standard value.
using PresetValues = std::map<std::string, double, std::less<>>;

/// The values of all parameters of a preset.
class PresetSizes {
public:
    PresetSizes(std::span<const PresetParameter> parameters, const PresetValues& stated);

    bool has(std::string_view key) const { return values_.contains(key); }
    /// The value of a parameter that the preset has.
    double operator[](std::string_view key) const;
    int count(std::string_view key) const { return static_cast<int>((*this)[key]); }

private:
    PresetValues values_;
};

/// A body with sizes that can be changed, for a fixture, a holder or a part of the machine.
struct Preset {
    using Generator = core::Result<core::Mesh> (*)(const PresetSizes& sizes);

    std::string_view name; // "vise-6"
    PresetKind kind;
    std::string_view title;  // "6 inch vise"
    std::string_view source; // of its sizes: a sentence
    std::string_view origin; // and axes: a sentence
    std::vector<PresetParameter> parameters;
    Generator generate;

    /// Null if it has no parameter with this key.
    const PresetParameter* parameter(std::string_view key) const;
};

/// All presets of fixtures, by kind, then by name, with numbers in names by their values.
std::span<const Preset> presets();

/// Null if there is none of this name.
const Preset* find_preset(std::string_view name);

/// A sentence for a name that no preset has, with the nearest name or where the list is.
std::string unknown_preset_text(std::string_view name);

/// Whether a name comes before another: runs of digits are compared as numbers, so "vise-6" comes
/// before "vise-10".
bool is_before_in_list(std::string_view a, std::string_view b);

/// Whether a value can be that of a parameter: it is in the range and, if it counts, whole.
bool fits(const PresetParameter& parameter, double value);

/// Errors:  invalid_value: a key that the preset does not have, or a value that does not fit. The
///          message names the keys or the range.
core::Result<void> check_preset_value(const Preset& preset, std::string_view key, double value);

/// The body of a preset, in mm, in its own frame.
///
/// Result:  one closed surface that faces outwards. Polygons replace circles: outside of them, or
///          inside for holes, by at most 0.05 mm, so no clearance to it is too large.
/// Errors:  those of check_preset_value; invalid_value for sizes that make no body together: the
///          message names their keys.
core::Result<core::Mesh> preset_mesh(const Preset& preset, const PresetValues& values = {});

} // namespace app

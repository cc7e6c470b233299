#include "app/setup/presets/preset.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/presets/preset_lists.h"
#include "core/base/text.h"

namespace app {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The run of digits, or else the single character, at the beginning of a name.
std::string_view first_item(std::string_view name) {
    size_t end = 0;
    while (end < name.size() && is_digit(name[end])) ++end;
    return name.substr(0, std::max<size_t>(end, 1));
}

std::string_view without_zeros(std::string_view digits) {
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    return digits;
}

/// Compares two items: negative, 0 or positive.
int compare_items(std::string_view a, std::string_view b) {
    if (!is_digit(a[0]) || !is_digit(b[0])) return a.compare(b);
    a = without_zeros(a);
    b = without_zeros(b);
    return a.size() != b.size() ? (a.size() < b.size() ? -1 : 1) : a.compare(b);
}

std::vector<Preset> sorted_presets() {
    std::vector<Preset> all;
    for (const auto list :
         {vise_presets, clamp_presets, block_presets, plate_presets, chuck_presets})
        for (Preset& preset : list()) all.push_back(std::move(preset));
    std::sort(all.begin(), all.end(), [](const Preset& a, const Preset& b) {
        return a.kind != b.kind ? a.kind < b.kind : is_before_in_list(a.name, b.name);
    });
    return all;
}

std::string unknown_key_text(const Preset& preset, std::string_view key) {
    std::vector<std::string> keys;
    for (const PresetParameter& known : preset.parameters) keys.emplace_back(known.key);
    const std::string nearest = core::nearest_name(key, keys);
    const bool is_near = core::edit_distance(key, nearest) < 3;
    return fmt::format("{} has no size {}; {}", preset.name, key,
                       is_near ? "did you mean " + nearest + "?"
                               : fmt::format("it has: {}", fmt::join(keys, " ")));
}

/// "a whole number from 1 to 20", "from 1 to 230 mm".
std::string range_text(const PresetParameter& parameter) {
    const std::string range = fmt::format("from {} to {}", core::number_text(parameter.least, 3),
                                          core::number_text(parameter.greatest, 3));
    return parameter.measure == PresetMeasure::count ? "a whole number " + range : range + " mm";
}

} // namespace

std::string_view name_of(PresetKind kind) {
    switch (kind) {
    case PresetKind::vise:
        return "vise";
    case PresetKind::clamp:
        return "clamp";
    case PresetKind::block:
        return "block";
    case PresetKind::plate:
        return "plate";
    case PresetKind::chuck:
        return "chuck";
    case PresetKind::holder:
        return "holder";
    }
    return {};
}

std::string_view title_of(PresetKind kind) {
    switch (kind) {
    case PresetKind::vise:
        return "Vises";
    case PresetKind::clamp:
        return "Clamps and studs";
    case PresetKind::block:
        return "Blocks and parallels";
    case PresetKind::plate:
        return "Plates, tables and tombstones";
    case PresetKind::chuck:
        return "Chucks, collet blocks and dividing heads";
    case PresetKind::holder:
        return "Holders";
    }
    return {};
}

tl::unexpected<core::Error> unfit_sizes(std::string why) {
    return core::fail(core::ErrorCode::invalid_value, std::move(why));
}

PresetSizes::PresetSizes(std::span<const PresetParameter> parameters, const PresetValues& stated) {
    for (const PresetParameter& parameter : parameters) {
        const auto found = stated.find(parameter.key);
        values_.emplace(parameter.key, found == stated.end() ? parameter.standard : found->second);
    }
}

double PresetSizes::operator[](std::string_view key) const {
    const auto found = values_.find(key);
    assert(found != values_.end());
    return found->second;
}

const PresetParameter* Preset::parameter(std::string_view key) const {
    for (const PresetParameter& each : parameters)
        if (each.key == key) return &each;
    return nullptr;
}

std::span<const Preset> presets() {
    static const std::vector<Preset> all = sorted_presets();
    return all;
}

const Preset* find_preset(std::string_view name) {
    for (const Preset& preset : presets())
        if (preset.name == name) return &preset;
    return nullptr;
}

std::string unknown_preset_text(std::string_view name) {
    std::vector<std::string> names;
    for (const Preset& preset : presets()) names.emplace_back(preset.name);
    const std::string nearest = core::nearest_name(name, names);
    const bool is_near = core::edit_distance(name, nearest) * 2 <= name.size();
    return is_near ? fmt::format("there is no preset \"{}\"; did you mean \"{}\"? \"feeler "
                                 "presets\" lists all",
                                 name, nearest)
                   : fmt::format("there is no preset \"{}\": \"feeler presets\" lists all", name);
}

bool is_before_in_list(std::string_view a, std::string_view b) {
    const std::string_view whole_a = a, whole_b = b;
    while (!a.empty() && !b.empty()) {
        const std::string_view first_a = first_item(a), first_b = first_item(b);
        if (const int order = compare_items(first_a, first_b); order != 0) return order < 0;
        a.remove_prefix(first_a.size());
        b.remove_prefix(first_b.size());
    }
    if (a.empty() != b.empty()) return a.empty();
    return whole_a < whole_b;
}

bool fits(const PresetParameter& parameter, double value) {
    const bool is_whole = parameter.measure != PresetMeasure::count || std::trunc(value) == value;
    return is_whole && value >= parameter.least && value <= parameter.greatest;
}

core::Result<void> check_preset_value(const Preset& preset, std::string_view key, double value) {
    const PresetParameter* parameter = preset.parameter(key);
    if (!parameter) return unfit_sizes(unknown_key_text(preset, key));
    if (fits(*parameter, value)) return {};
    return unfit_sizes(fmt::format("{} must be {}", key, range_text(*parameter)));
}

core::Result<core::Mesh> preset_mesh(const Preset& preset, const PresetValues& values) {
    for (const auto& [key, value] : values)
        if (const auto checked = check_preset_value(preset, key, value); !checked)
            return tl::unexpected(checked.error());
    return preset.generate(PresetSizes(preset.parameters, values));
}

} // namespace app

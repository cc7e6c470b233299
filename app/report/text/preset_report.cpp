#include "app/report/text/preset_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "core/base/text.h"

namespace app {
namespace {

using PresetJson = nlohmann::ordered_json;

std::string number(double value) { return core::number_text(value, 3); }

size_t longest_name() {
    size_t longest = 0;
    for (const Preset& preset : presets()) longest = std::max(longest, preset.name.size());
    return longest;
}

std::string unit_of(const PresetParameter& parameter) {
    return parameter.measure == PresetMeasure::length ? "mm" : "count";
}

double value_of(const PresetParameter& parameter, const PresetValues& values) {
    const auto found = values.find(parameter.key);
    return found == values.end() ? parameter.standard : found->second;
}

/// The lines of a set-up with this preset.
std::string setup_lines(const Preset& preset, const PresetValues& values) {
    std::string lines = fmt::format("    [[fixture]]\n    name = \"{}-1\"\n    preset = \"{}\"\n",
                                    name_of(preset.kind), preset.name);
    for (const auto& [key, value] : values) lines += fmt::format("    {} = {}\n", key, value);
    return lines + "    at = [0, 0, 0]\n";
}

std::string parameter_rows(const Preset& preset, const PresetValues& values) {
    size_t key_width = 3;
    for (const PresetParameter& each : preset.parameters)
        key_width = std::max(key_width, each.key.size());
    std::string rows;
    for (const PresetParameter& each : preset.parameters) {
        const std::string range =
            fmt::format("{} to {}", number(each.least), number(each.greatest));
        rows += fmt::format("  {:{}} {:>8}   {:14} {}\n", each.key, key_width,
                            number(value_of(each, values)), range, each.meaning);
    }
    return rows;
}

PresetJson json_of(const Preset& preset, const PresetValues& values) {
    PresetJson parameters = PresetJson::array();
    for (const PresetParameter& each : preset.parameters)
        parameters.push_back({{"key", each.key},
                              {"unit", unit_of(each)},
                              {"value", value_of(each, values)},
                              {"standard", each.standard},
                              {"least", each.least},
                              {"greatest", each.greatest},
                              {"meaning", each.meaning}});
    return {{"name", preset.name},     {"kind", name_of(preset.kind)}, {"title", preset.title},
            {"source", preset.source}, {"origin", preset.origin},      {"parameters", parameters}};
}

PresetJson json_of(const core::Vec3& p) { return PresetJson::array({p.x, p.y, p.z}); }

} // namespace

std::string presets_text() {
    std::string text;
    for (const PresetKind kind : preset_kinds) {
        text += fmt::format("{}{}\n", text.empty() ? "" : "\n", title_of(kind));
        for (const Preset& preset : presets())
            if (preset.kind == kind)
                text += fmt::format("  {:{}}  {}\n", preset.name, longest_name(), preset.title);
    }
    return text + "\n\"feeler presets NAME\" shows the sizes of one.\n";
}

std::string presets_json() {
    PresetJson all = PresetJson::array();
    for (const Preset& preset : presets()) all.push_back(json_of(preset, {}));
    return PresetJson{{"presets", all}}.dump(1) + "\n";
}

core::Result<std::string> preset_text(const Preset& preset, const PresetValues& values) {
    FEELER_TRY(const core::Mesh mesh, preset_mesh(preset, values));
    const core::Aabb box = mesh.bounds();
    std::string text = fmt::format("{}: {}\n\n", preset.name, preset.title);
    text += wrapped("Sizes: " + std::string(preset.source), 2, 8, 100);
    text += wrapped("Origin: " + std::string(preset.origin), 2, 8, 100);
    text += fmt::format("  Box: X {} to {}, Y {} to {}, Z {} to {}\n\n", number(box.min.x),
                        number(box.max.x), number(box.min.y), number(box.max.y), number(box.min.z),
                        number(box.max.z));
    text += "Sizes in mm, with their ranges:\n\n" + parameter_rows(preset, values);
    return text + "\nIn a set-up:\n\n" + setup_lines(preset, values);
}

core::Result<std::string> preset_json(const Preset& preset, const PresetValues& values) {
    FEELER_TRY(const core::Mesh mesh, preset_mesh(preset, values));
    PresetJson json = json_of(preset, values);
    const core::Aabb box = mesh.bounds();
    json["box"] = PresetJson::array({json_of(box.min), json_of(box.max)});
    json["volume"] = core::signed_volume(mesh);
    json["triangles"] = mesh.triangles.size();
    return json.dump(1) + "\n";
}

} // namespace app

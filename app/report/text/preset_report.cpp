#include "app/report/text/preset_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "app/setup/holders/holder_preset.h"
#include "app/setup/machines/machine_preset.h"
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

/// The lines of a set-up with a tool in this holder.
std::string tool_lines(const Preset& preset, PresetValues values) {
    std::string name(preset.name);
    if (const auto length = values.find("length"); length != values.end()) {
        name += "-" + core::number_text(length->second, 6);
        values.erase(length);
    }
    std::string sizes;
    for (const auto& [key, value] : values) sizes += fmt::format(", {} = {}", key, value);
    const std::string holder = sizes.empty() ? fmt::format("\"{}\"", name)
                                             : fmt::format("{{ preset = \"{}\"{} }}", name, sizes);
    return fmt::format("    [[tool]]\n    number = 1\n    holder = {}\n", holder);
}

/// The lines of a set-up with this preset.
std::string setup_lines(const Preset& preset, const PresetValues& values) {
    if (preset.kind == PresetKind::holder) return tool_lines(preset, values);
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

// --- holders and machines ---

/// The sizes in the names of attachments that a taper takes, of one kind: "11-40".
std::string sizes_of(const HolderTaper& taper, HolderKind kind) {
    std::string first, last;
    for (const HolderAttachment& attachment : holder_attachments()) {
        if (attachment.kind != kind || attachment.is_inch
            || !why_no_holder(taper, attachment).empty())
            continue;
        last = core::number_text(attachment.size, 3);
        if (first.empty()) first = last;
    }
    return first.empty() ? "-" : first == last ? first : first + "-" + last;
}

/// All attachments of a kind: "ER11 ER16 ER20".
std::string names_of(HolderKind kind) {
    std::string names;
    for (const HolderAttachment& attachment : holder_attachments())
        if (attachment.kind == kind) names += (names.empty() ? "" : " ") + attachment.name;
    return names;
}

std::string letters_of(HolderKind kind) {
    const std::string names = names_of(kind);
    return names.substr(0, names.find_first_of("0123456789"));
}

std::string without_blanks_at_end(std::string text) {
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
}

std::string holders_text() {
    std::string text =
        "\nHolders: taper, attachment and, if it is not the usual one, the length in "
        "mm, as in CAT40-ER16-85\n  taper   ";
    for (const HolderKind kind : holder_kinds) text += fmt::format("  {:6}", letters_of(kind));
    for (const HolderTaper& taper : holder_tapers()) {
        std::string row = fmt::format("  {:8}", taper.name);
        for (const HolderKind kind : holder_kinds)
            row += fmt::format("  {:6}", sizes_of(taper, kind));
        text = without_blanks_at_end(text) + "\n" + row;
    }
    text = without_blanks_at_end(text) + "\n\n";
    for (const HolderKind kind : holder_kinds)
        text += wrapped(fmt::format("{}: {}", title_of(kind), names_of(kind)), 2, 8, 100);
    return text + "  Sizes in inches are for CAT40, CAT50 and R8.\n";
}

std::string machines_text() {
    size_t width = 0;
    for (const MachinePreset& machine : machine_presets())
        width = std::max(width, machine.name.size());
    std::string text = "\nMachines\n";
    for (const MachineKind kind : machine_kinds) {
        text += fmt::format("  {}\n", title_of(kind));
        for (const MachinePreset& machine : machine_presets())
            if (machine.kind == kind)
                text += fmt::format("    {:{}}  {}\n", machine.name, width, machine.title);
    }
    return text;
}

PresetJson json_of(const HolderPreset& holder) {
    return {{"name", holder.preset.name},
            {"taper", holder.taper->name},
            {"attachment", holder.attachment->name},
            {"title", holder.preset.title},
            {"length", holder.preset.parameter("length")->standard}};
}

PresetJson json_of(const MachinePreset& machine) {
    PresetJson json = {{"name", machine.name},     {"kind", name_of(machine.kind)},
                       {"title", machine.title},   {"is_generic", machine.is_generic},
                       {"source", machine.source}, {"zero", machine.zero}};
    if (!machine.taper.empty()) json["taper"] = machine.taper;
    return json;
}

/// Where the value of a size comes from.
std::string origin_of(const MachineSize& size, const PresetValues& values) {
    if (values.contains(size.key)) return "stated";
    if (!size.standard) return "open";
    return size.is_typical ? "typical" : "source";
}

std::optional<double> value_of(const MachineSize& size, const PresetValues& values) {
    const auto found = values.find(size.key);
    return found == values.end() ? size.standard : std::optional(found->second);
}

std::string size_rows(const MachinePreset& machine, const PresetValues& values) {
    size_t width = 3;
    for (const MachineSize& size : machine.sizes) width = std::max(width, size.key.size());
    std::string rows;
    for (const MachineSize& size : machine.sizes) {
        const auto value = value_of(size, values);
        rows += fmt::format("  {:{}} {:>10} {:8} {:8} {}\n", size.key, width,
                            value ? number(*value) : "-", value ? name_of(size.unit) : "",
                            origin_of(size, values), size.meaning);
    }
    return rows;
}

PresetJson json_of(const MachineSize& size, const PresetValues& values) {
    const auto value = value_of(size, values);
    return {{"key", size.key},
            {"unit", name_of(size.unit)},
            {"value", value ? PresetJson(*value) : PresetJson()},
            {"origin", origin_of(size, values)},
            {"least", size.least},
            {"greatest", size.greatest},
            {"meaning", size.meaning}};
}

} // namespace

std::string presets_text() {
    std::string text;
    for (const PresetKind kind : preset_kinds) {
        text += fmt::format("{}{}\n", text.empty() ? "" : "\n", title_of(kind));
        for (const Preset& preset : presets())
            if (preset.kind == kind)
                text += fmt::format("  {:{}}  {}\n", preset.name, longest_name(), preset.title);
    }
    return text + holders_text() + machines_text()
           + "\n\"feeler presets NAME\" shows the sizes of one.\n";
}

std::string presets_json() {
    PresetJson all = PresetJson::array();
    for (const Preset& preset : presets()) all.push_back(json_of(preset, {}));
    PresetJson holders = PresetJson::array(), machines = PresetJson::array();
    for (const HolderPreset& holder : holder_presets()) holders.push_back(json_of(holder));
    for (const MachinePreset& machine : machine_presets()) machines.push_back(json_of(machine));
    return PresetJson{{"presets", all}, {"holders", holders}, {"machines", machines}}.dump(1)
           + "\n";
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

core::Result<std::string> machine_report(const MachinePreset& machine, const PresetValues& values) {
    FEELER_TRY(const MachineText made, machine_text(machine, values));
    std::string text = fmt::format("{}: {}\n\n", machine.name, machine.title);
    text += wrapped("Source: " + std::string(machine.source), 2, 8, 100);
    text += wrapped("Machine zero: " + std::string(machine.zero), 2, 8, 100);
    if (!machine.taper.empty()) text += fmt::format("  Holders: {}-...\n", machine.taper);
    text += "\nSizes, and where they come from:\n\n" + size_rows(machine, values);
    for (const std::string& note : made.notes)
        if (note.starts_with("nothing states"))
            text += "\n" + wrapped("N" + note.substr(1) + ".", 0, 2, 100);
    text += fmt::format("\nIn a set-up:\n\n    [machine]\n    preset = \"{}\"\n", machine.name);
    for (const auto& [key, value] : values) text += fmt::format("    {} = {}\n", key, value);
    return text;
}

core::Result<std::string> machine_json(const MachinePreset& machine, const PresetValues& values) {
    FEELER_TRY(const MachineText made, machine_text(machine, values));
    PresetJson json = json_of(machine);
    json["sizes"] = PresetJson::array();
    for (const MachineSize& size : machine.sizes) json["sizes"].push_back(json_of(size, values));
    json["notes"] = made.notes;
    json["file"] = made.toml;
    return json.dump(1) + "\n";
}

} // namespace app

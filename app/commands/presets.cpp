#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/preset_arguments.h"
#include "app/commands/suggestion.h"
#include "app/report/text/preset_report.h"
#include "app/setup/holders/holder_preset.h"
#include "app/setup/machines/machine_preset.h"
#include "core/base/text.h"

namespace app {
namespace {

struct PresetOptions {
    std::string name, output;
    std::string format = "text";
    std::vector<std::string> values;
};

/// Accepts the names of presets. Shells complete them from the list in its description, which is
/// made only when it is asked for: there are hundreds of holders.
struct PresetName : CLI::Validator {
    PresetName() {
        func_ = [](const std::string& name) {
            if (find_machine_preset(name)) return std::string();
            const auto named = named_preset(name);
            return named ? std::string() : named.error().message;
        };
        desc_function_ = [] {
            std::vector<std::string_view> names;
            for (const Preset& preset : presets()) names.push_back(preset.name);
            for (const MachinePreset& machine : machine_presets()) names.push_back(machine.name);
            for (const HolderPreset& holder : holder_presets()) names.push_back(holder.preset.name);
            return fmt::format("{{{}}}", fmt::join(names, ","));
        };
    }
};

bool names_mesh(const std::string& path) {
    const std::string output = core::lower_case(path);
    return output.ends_with(".stl") || output.ends_with(".ply");
}

/// The mesh, if the output is a mesh file; else the text or JSON.
core::Result<std::string> preset_output(const PresetOptions& options, const Preset& preset,
                                        const PresetValues& values) {
    const bool is_stl = core::lower_case(options.output).ends_with(".stl");
    if (!names_mesh(options.output))
        return options.format == "json" ? preset_json(preset, values) : preset_text(preset, values);
    FEELER_TRY(const core::Mesh mesh, preset_mesh(preset, values));
    const std::string comment = fmt::format("{} of Feeler, mm", preset.name);
    return is_stl ? core::stl_bytes(mesh, comment) : core::ply_bytes(mesh, {comment});
}

/// The machine file, if the output is one; else the text or JSON.
core::Result<std::string> machine_output(const PresetOptions& options,
                                         const MachinePreset& machine) {
    FEELER_TRY(const PresetValues values, machine_values(machine, options.values));
    if (names_mesh(options.output))
        return core::fail(core::ErrorCode::invalid_value,
                          fmt::format("{0} is a machine and has no mesh: write its file with -o "
                                      "{0}.toml",
                                      machine.name));
    if (core::lower_case(options.output).ends_with(".toml")) {
        FEELER_TRY(MachineText made, machine_text(machine, values));
        return std::move(made.toml);
    }
    return options.format == "json" ? machine_json(machine, values)
                                    : machine_report(machine, values);
}

core::Result<std::string> one_preset(const PresetOptions& options) {
    if (const MachinePreset* machine = find_machine_preset(options.name))
        return machine_output(options, *machine);
    FEELER_TRY(ChosenPreset chosen, named_preset(options.name));
    FEELER_TRY(const PresetValues values, preset_values(*chosen.preset, options.values));
    for (const auto& [key, value] : values)
        if (!chosen.values.emplace(key, value).second)
            return core::fail(core::ErrorCode::invalid_value, key + " is part of the name already");
    return preset_output(options, *chosen.preset, chosen.values);
}

core::Result<std::string> text_of_presets(const PresetOptions& options) {
    if (!options.name.empty()) return one_preset(options);
    if (!options.values.empty())
        return core::fail(core::ErrorCode::missing_value, "--set needs the name of a preset");
    if (names_mesh(options.output))
        return core::fail(core::ErrorCode::missing_value,
                          "a mesh file needs the name of a preset: feeler presets NAME -o FILE");
    return options.format == "json" ? presets_json() : presets_text();
}

ExitCode presets_command(const PresetOptions& options) {
    const auto text = text_of_presets(options);
    if (!text) return failed(text.error());
    const auto written = write_output(options.output, *text);
    return written ? ExitCode::clear : failed(written.error());
}

constexpr const char* presets_examples = R"(
Examples:
  feeler presets                                          all names, by kind
  feeler presets vise-6                                   its sizes, and lines for a set-up
  feeler presets vise-6 --set opening=40 -o vise.stl      its mesh
  feeler presets BT40-ER32-100                            a holder, 100 mm long
  feeler presets haas-vf-2 -o vf2.toml                    a machine as a file to edit)";

} // namespace

void add_presets(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<PresetOptions>();
    CLI::App& command = *cli.add_subcommand(
        "presets", "List fixtures, holders and machines that a set-up can name");
    command.add_option("name", options->name, "Preset whose sizes are shown")
        ->check(PresetName())
        ->option_text("NAME");
    command.add_option("--set", options->values, "Set a size: KEY=VALUE, in mm; may be repeated")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    command.add_option("--format", options->format, "text or json")
        ->check(one_of({"text", "json"}))
        ->capture_default_str();
    add_path(command, "-o,--output", options->output,
             "Write to this file; with .stl or .ply, the mesh of the preset in mm; with .toml, the "
             "machine as a file");
    command.footer(presets_examples);
    command.callback([options, &exit_code] { exit_code = presets_command(*options); });
}

} // namespace app

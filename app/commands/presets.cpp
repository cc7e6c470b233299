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
#include "core/base/text.h"

namespace app {
namespace {

struct PresetOptions {
    std::string name, output;
    std::string format = "text";
    std::vector<std::string> values;
};

/// Accepts the names of presets. Shells complete them from the list in its description.
CLI::Validator preset_name() {
    std::vector<std::string_view> names;
    for (const Preset& preset : presets()) names.push_back(preset.name);
    return CLI::Validator(
        [](const std::string& name) {
            return find_preset(name) ? std::string() : unknown_preset_text(name);
        },
        fmt::format("{{{}}}", fmt::join(names, ",")));
}

/// The mesh, if the output is a mesh file; else the text or JSON.
core::Result<std::string> preset_output(const PresetOptions& options, const Preset& preset,
                                        const PresetValues& values) {
    const std::string output = core::lower_case(options.output);
    const bool is_stl = output.ends_with(".stl"), is_ply = output.ends_with(".ply");
    if (!is_stl && !is_ply)
        return options.format == "json" ? preset_json(preset, values) : preset_text(preset, values);
    FEELER_TRY(const core::Mesh mesh, preset_mesh(preset, values));
    const std::string comment = fmt::format("{} of Feeler, mm", preset.name);
    return is_stl ? core::stl_bytes(mesh, comment) : core::ply_bytes(mesh, {comment});
}

core::Result<std::string> text_of_presets(const PresetOptions& options) {
    if (!options.name.empty()) {
        FEELER_TRY(const Preset* preset, named_preset(options.name));
        FEELER_TRY(const PresetValues values, preset_values(*preset, options.values));
        return preset_output(options, *preset, values);
    }
    if (!options.values.empty())
        return core::fail(core::ErrorCode::missing_value, "--set needs the name of a preset");
    const std::string output = core::lower_case(options.output);
    if (output.ends_with(".stl") || output.ends_with(".ply"))
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
  feeler presets vise-6 --set opening=40 -o vise.stl      its mesh)";

} // namespace

void add_presets(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<PresetOptions>();
    CLI::App& command = *cli.add_subcommand(
        "presets", "List vises, clamps and other fixtures that a set-up can name");
    command.add_option("name", options->name, "Preset whose sizes are shown")->check(preset_name());
    command.add_option("--set", options->values, "Set a size: KEY=VALUE, in mm; may be repeated")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    command.add_option("--format", options->format, "text or json")
        ->check(one_of({"text", "json"}))
        ->capture_default_str();
    add_path(command, "-o,--output", options->output,
             "Write to this file; with .stl or .ply, the mesh of the preset in mm");
    command.footer(presets_examples);
    command.callback([options, &exit_code] { exit_code = presets_command(*options); });
}

} // namespace app

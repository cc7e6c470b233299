#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/number_range.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/viewer/window.h"

namespace app {
namespace {

struct Options {
    std::string program, setup;
    std::optional<double> allowance, mesh_size;
    ProgramArguments reading;
};

/// A folder of the user, from the environment or below home; empty when neither is known.
std::filesystem::path user_folder(const char* variable, const char* below_home) {
    if (const char* stated = std::getenv(variable); stated && *stated) return stated;
    if (const char* home = std::getenv("HOME"); home && *home)
        return std::filesystem::path(home) / below_home;
    return {};
}

/// Where pictures go: the user's folder for them, else beside the program.
std::filesystem::path pictures_folder(const std::string& program) {
    const std::filesystem::path pictures = user_folder("XDG_PICTURES_DIR", "Pictures");
    std::error_code ignored;
    if (!pictures.empty() && std::filesystem::is_directory(pictures, ignored)) return pictures;
    return std::filesystem::path(program).parent_path();
}

ExitCode view(const Options& options) {
    const auto settings = settings_of(options.reading);
    if (!settings) {
        print_error(settings.error());
        return ExitCode::failed;
    }
    viewer::WindowJob job;
    if (!options.program.empty()) {
        CheckJob check;
        check.program = options.program;
        check.setup = options.setup;
        check.allowance = options.allowance;
        check.mesh_size = options.mesh_size;
        check.settings = *settings;
        job.check = std::move(check);
    }
    if (const auto folder = user_folder("XDG_CONFIG_HOME", ".config"); !folder.empty())
        job.settings_file = folder / "feeler" / "view.toml";
    job.pictures = pictures_folder(options.program);
    const auto shown = viewer::run_window(job);
    if (shown) return ExitCode::clear;
    fmt::print(stderr, "feeler: {}; feeler shot {} --worst -o picture.png needs none\n",
               shown.error().message, options.program.empty() ? "PROGRAM" : options.program);
    return ExitCode::failed;
}

} // namespace

void add_view(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<Options>();
    CLI::App& command =
        *cli.add_subcommand("view", "Step through a program in a window and see it");
    command.add_option("program", options->program, "NC program; it can also be dropped in");
    command.add_option("--setup", options->setup,
                       "Set-up file (TOML); else it is inferred from the program, and said");
    command
        .add_option("--allowance", options->allowance,
                    "Clearance to keep from fixtures, and of the holder from the stock, mm")
        ->check(number_range(0.0, 1000.0));
    command.add_option("--mesh-size", options->mesh_size, "Spacing of the scan lines, mm")
        ->check(number_range(1e-300, 1e300));
    add_program_arguments(command, options->reading);
    command.callback([options, &exit_code] { exit_code = view(*options); });
}

} // namespace app

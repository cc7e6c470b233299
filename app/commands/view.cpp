#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/commands/commands.h"
#include "app/commands/job_file.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/sheet.h"
#include "app/commands/suggestion.h"
#include "app/view/ui/window.h"
#include "core/base/platform.h"

namespace app {
namespace {

/// Folder for pictures: the user's pictures folder, else that of the program.
std::filesystem::path pictures_folder(const std::string& program) {
    const std::filesystem::path pictures = core::platform::pictures_folder();
    std::error_code ignored;
    if (!pictures.empty() && std::filesystem::is_directory(pictures, ignored)) return pictures;
    return std::filesystem::path(program).parent_path();
}

struct ViewOptions {
    CheckArguments what;
    DeviceArguments device;
    std::vector<std::string> programs;
    std::string frame_log;
};

core::Result<std::string> sheet_page(CheckJob check, const std::function<bool()>& goes_on) {
    check.is_stopped = [&goes_on] { return !goes_on(); };
    check.after_block = [&goes_on](const CheckProgress&) { return goes_on(); };
    FEELER_TRY(MadeSheet sheet, make_dated_sheet(check, {.goes_on = goes_on}));
    return std::move(sheet.html);
}

ExitCode view(const ViewOptions& options) {
    viewer::WindowJob job;
    CheckArguments arguments = options.what;
    for (const std::string& program : options.programs) {
        arguments.program = program;
        auto check = job_of(arguments);
        if (!check) return failed(check.error());
        job.checks.push_back(std::make_shared<const CheckJob>(*std::move(check)));
    }
    const std::string first = options.programs.empty() ? "" : options.programs.front();
    if (const auto folder = core::platform::settings_folder(); !folder.empty()) {
        job.settings_file = folder / "feeler" / "view.toml";
        job.notes_file = folder / "feeler" / "notes.toml";
        job.recent_file = folder / "feeler" / "recent.toml";
        job.unsaved = folder / "feeler" / "unsaved";
    }
    job.device = {options.device.file, options.device.shown};
    job.write = [](const std::string& path, const std::string& text) {
        return write_output(path, text);
    };
    job.make_sheet = sheet_page;
    job.read_job_file = read_job_file;
    job.pictures = pictures_folder(first);
    job.frame_log = options.frame_log;
    const auto shown = viewer::run_window(job);
    if (shown) return ExitCode::clear;
    print_note(fmt::format("feeler: {}; feeler shot {} --worst -o picture.png needs no display\n",
                           shown.error().message, first.empty() ? "PROGRAM" : first));
    return ExitCode::failed;
}

} // namespace

void add_view(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<ViewOptions>();
    CLI::App& command = *cli.add_subcommand("view", "Step through a program in a window, in 3D");
    add_path(command, "program", options->programs,
             "NC programs, each in a tab; they can also be dropped on the window");
    add_check_options(command, options->what);
    add_device_arguments(command, options->device);
    add_path(command, "--frame-log", options->frame_log, "")->group(""); // for measuring
    command.callback([options, &exit_code] { exit_code = view(*options); });
}

} // namespace app

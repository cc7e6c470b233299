#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/read_files.h"
#include "app/commands/setup_control.h"
#include "app/commands/suggestion.h"
#include "app/setup/inference/imported_setup.h"
#include "app/setup/inference/inferred_setup.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_text.h"
#include "gcode/text/source.h"

namespace app {
namespace {

struct SetupOptions {
    std::string program, output, import;
    bool force = false;
    ProgramArguments reading;
    ControlArguments control;
};

core::Result<void> write_setup(const SetupOptions& options) {
    const ReadFiles read;
    if (auto safe = check_output(options.output, {options.program}); !safe) return safe;
    std::error_code ignored;
    if (!options.force && std::filesystem::is_regular_file(options.output, ignored))
        return tl::unexpected<core::Error>(
            {core::ErrorCode::invalid_value,
             {},
             "is there already and may contain what you have written: choose another file for -o, "
             "or replace it with --force",
             options.output});
    FEELER_TRY(const ProgramSettings settings, settings_of(options.reading));
    FEELER_TRY(const gcode::Program program, gcode::read_program(options.program));
    FEELER_TRY(const SetupFile setup, options.import.empty()
                                          ? infer_setup(program, settings)
                                          : infer_setup_with(program, settings, options.import));
    const std::string folder = std::filesystem::path(options.output).parent_path().generic_string();
    return write_output(options.output, setup_text(setup, {options.program, settings, folder}),
                        read);
}

core::Result<ExitCode> carry_out(const SetupOptions& options) {
    if (!options.control.files.empty())
        return compare_with_control(options.program, options.reading, options.control,
                                    options.output);
    if (auto written = write_setup(options); !written) return tl::unexpected(written.error());
    return ExitCode::clear;
}

ExitCode setup(const SetupOptions& options) {
    const auto done = carry_out(options);
    return done ? *done : failed(core::in_file(done.error(), options.program));
}

} // namespace

void add_setup(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<SetupOptions>();
    CLI::App& command =
        *cli.add_subcommand("setup", "Infer a set-up from a program and write it to a file");
    add_path(command, "program", options->program, "NC program")->required();
    add_path(command, "-o,--output", options->output, "File for the set-up");
    command.add_flag("--force", options->force, "Replace the file if it is there already");
    add_path(command, "--from", options->import,
             "Take tools and stock from a FreeCAD job (.FCStd), or tools from a library (.tools, "
             ".hsmlib, .json, .fctl, .fctb, .tbl)");
    add_control_arguments(command, options->control);
    command.get_option("--from")->excludes(command.get_option("--control"));
    add_program_arguments(command, options->reading);
    command.callback([options, &exit_code] { exit_code = setup(*options); });
}

} // namespace app

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/base/text.h"
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
#include "app/setup/setup_update.h"
#include "core/base/file_reads.h"
#include "gcode/text/source.h"

namespace app {
namespace {

struct SetupOptions {
    std::string program, output, import;
    bool force = false, update = false;
    ProgramArguments reading;
    ControlArguments control;
};

/// Refuses to replace the program, or without --force a file that is there already.
core::Result<void> check_place(const SetupOptions& options) {
    if (auto safe = check_output(options.output, {options.program}); !safe) return safe;
    std::error_code ignored;
    if (!options.force && std::filesystem::is_regular_file(options.output, ignored))
        return tl::unexpected<core::Error>(
            {core::ErrorCode::invalid_value,
             {},
             "is there already and may contain what you have written: add to it with --update, "
             "choose another file for -o, or replace it with --force",
             options.output});
    return {};
}

core::Result<void> write_setup(const SetupOptions& options) {
    const ReadFiles read;
    if (!options.control.setup.empty())
        return tl::unexpected<core::Error>(
            {core::ErrorCode::invalid_value, {}, "--setup needs --update or --control", {}});
    if (auto free = check_place(options); !free) return free;
    FEELER_TRY(const ProgramSettings settings, settings_of(options.reading));
    FEELER_TRY(const gcode::Program program, gcode::read_program(options.program));
    FEELER_TRY(const SetupFile setup, options.import.empty()
                                          ? infer_setup(program, settings)
                                          : infer_setup_with(program, settings, options.import));
    const std::string folder = std::filesystem::path(options.output).parent_path().generic_string();
    return write_output(options.output, setup_text(setup, {options.program, settings, folder}),
                        read);
}

void print_update(const SetupUpdate& update, const std::string& path) {
    std::string text;
    for (const std::string& each : update.added) text += wrapped("added: " + each, 0, 2);
    for (const std::string& each : update.unused)
        text += wrapped("not used by the program: " + each, 0, 2);
    if (update.added.empty()) text += path + " has everything that the program says already\n";
    std::fputs(printable(text).c_str(), stdout);
}

core::Result<void> update_setup(const SetupOptions& options) {
    const ReadFiles read;
    const std::string path =
        options.control.setup.empty() ? setup_next_to(options.program) : options.control.setup;
    if (path.empty())
        return tl::unexpected<core::Error>(
            {core::ErrorCode::invalid_value,
             {},
             "has no set-up next to it: name one with --setup, or write one with -o",
             options.program});
    const std::string output = options.output.empty() ? path : options.output;
    if (output != path) {
        if (auto free = check_place(options); !free) return free;
    }
    FEELER_TRY(const ProgramSettings settings, settings_of(options.reading));
    FEELER_TRY(const gcode::Program program, gcode::read_program(options.program));
    const auto text = core::file_bytes(path);
    if (!text)
        return tl::unexpected<core::Error>({core::ErrorCode::io, {}, "cannot be read", path});
    FEELER_TRY(const SetupFile file, completed_setup(*text, path, program, settings));
    auto update = updated_setup(*text, file);
    if (!update) return tl::unexpected(core::in_file(std::move(update).error(), path));
    if (output != path || update->text != *text) {
        if (auto written = write_output(output, update->text); !written) return written;
    }
    print_update(*update, output);
    return {};
}

core::Result<ExitCode> carry_out(const SetupOptions& options) {
    if (options.update) {
        if (auto done = update_setup(options); !done) return tl::unexpected(done.error());
        return ExitCode::clear;
    }
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
    command.add_flag("--update", options->update,
                     "Add to the set-up what the program says and the set-up lacks");
    add_path(
        command, "--from", options->import,
        "Take tools, stock and part from a FreeCAD job (.FCStd), or tools from a library (.tools, "
        ".hsmlib, .json, .fctl, .fctb, .tbl)");
    add_control_arguments(command, options->control);
    command.get_option("--from")->excludes(command.get_option("--control"));
    for (const char* other : {"--from", "--control"})
        command.get_option("--update")->excludes(command.get_option(other));
    add_program_arguments(command, options->reading);
    command.callback([options, &exit_code] { exit_code = setup(*options); });
}

} // namespace app

#include "app/commands/sheet.h"

#include <ctime>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/base/file_stamp.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/progress.h"
#include "app/commands/read_files.h"
#include "app/commands/suggestion.h"

namespace app {
namespace {

struct SheetOptions {
    CheckArguments what;
    std::string output;
    bool tolerances = false, no_pictures = false;
};

/// "2026-11-27 05:50", local time.
std::string minute_text(std::time_t time) {
    return fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(time));
}

std::string date_of_file(const std::string& path) {
    const FileStamp stamp = stamp_of(path);
    return stamp.is_file ? minute_text(static_cast<std::time_t>(stamp.modified / 1'000'000'000))
                         : std::string();
}

core::Result<MadeSheet> made(CheckJob job, const SheetOptions& options) {
    ProgressLine line;
    job.is_stopped = is_interrupted;
    job.after_block = [&line](const CheckProgress& progress) {
        line.show(progress);
        return !is_interrupted();
    };
    auto sheet = make_dated_sheet(job, {.tolerances = options.tolerances,
                                        .pictures = !options.no_pictures,
                                        .goes_on = [] { return !is_interrupted(); }});
    line.clear();
    return sheet;
}

} // namespace

core::Result<MadeSheet> make_dated_sheet(const CheckJob& job, SheetWishes wishes) {
    wishes.program_date = date_of_file(job.program);
    wishes.check_date = minute_text(std::time(nullptr));
    return make_sheet(job, wishes);
}

namespace {

core::Result<ExitCode> write_sheet(const SheetOptions& options) {
    ReadFiles read;
    FEELER_TRY(const CheckJob job, job_of(options.what));
    for (const std::string& path : {job.program, job.setup}) read.add(path);
    if (auto safe = read.check(options.output); !safe) return tl::unexpected(safe.error());
    stop_on_interrupt();
    FEELER_TRY(const MadeSheet sheet, made(job, options));
    if (auto written = write_output(options.output, sheet.html, read); !written)
        return tl::unexpected(written.error());
    if (sheet.tolerances_were_stopped) return ExitCode::failed;
    return sheet.has_errors ? ExitCode::findings : ExitCode::clear;
}

ExitCode sheet(const SheetOptions& options) {
    const auto written = write_sheet(options);
    if (written) return *written;
    const ExitCode code = failed(written.error());
    print_note("feeler: there is no sheet\n");
    return code;
}

constexpr const char* sheet_examples = R"(
Examples:
  feeler sheet plate.nc -o plate.html                     one page to print, with the set-up next to it
  feeler sheet plate.nc --tolerances -o plate.html        and how wrong each value may be)";

} // namespace

void add_sheet(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<SheetOptions>();
    CLI::App& command =
        *cli.add_subcommand("sheet", "Check a program and write its set-up sheet, a page to print");
    add_check_arguments(command, options->what)->required();
    add_path(command, "-o,--output", options->output, "Write the sheet to this file (.html)");
    command.add_flag("--tolerances", options->tolerances,
                     "Also find how far each value of the set-up may deviate; takes some hundred "
                     "times as long");
    command.add_flag("--no-pictures", options->no_pictures, "Leave the pictures out");
    command.footer(sheet_examples);
    command.callback([options, &exit_code] { exit_code = sheet(*options); });
}

} // namespace app

#include <chrono>
#include <ctime>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/base/file_stamp.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/progress.h"
#include "app/commands/read_files.h"
#include "app/commands/suggestion.h"
#include "app/report/sheet/html_sheet.h"
#include "app/tolerance/tolerances.h"
#include "core/base/file_reads.h"

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

/// The content of the sheet of this very program: it may have been saved again since the check.
///
/// Errors: those of read_check.
core::Result<SheetContent> content_of(const CheckJob& job, const CheckRun& run) {
    FEELER_TRY(const PreparedCheck check, read_check(job));
    if (check.run.sha256 != run.sha256)
        return tl::unexpected<core::Error>(
            {core::ErrorCode::io, {}, "was changed while it was checked: try again", job.program});
    SheetContent content =
        sheet_content(check, core::file_bytes(job.setup).value_or(std::string()));
    content.program_date = date_of_file(job.program);
    content.check_date = minute_text(std::time(nullptr));
    return content;
}

core::Result<CheckRun> checked_program(CheckJob job) {
    ProgressLine line;
    job.after_block = [&line](const CheckProgress& progress) {
        line.show(progress);
        return !is_interrupted();
    };
    auto run = run_check(job);
    line.clear();
    return run;
}

core::Result<ExitCode> write_sheet(const SheetOptions& options) {
    ReadFiles read;
    FEELER_TRY(CheckJob job, job_of(options.what));
    job.is_stopped = is_interrupted;
    for (const std::string& path : {job.program, job.setup}) read.add(path);
    if (auto safe = read.check(options.output); !safe) return tl::unexpected(safe.error());
    stop_on_interrupt();
    FEELER_TRY(CheckRun run, checked_program(job));
    if (run.stopped) {
        print_error(*run.stopped);
        return core::fail(core::ErrorCode::invalid_value,
                          "there is no sheet: the program did not run to its end");
    }
    FEELER_TRY(SheetContent content, content_of(job, run));
    if (options.tolerances) {
        FEELER_TRY(Tolerances tolerances,
                   tolerances_of(job, run, [](double) { return !is_interrupted(); }));
        run.tolerances = std::make_shared<const Tolerances>(std::move(tolerances));
        content.tolerances_were_stopped = is_interrupted();
    }
    content.pictures = options.no_pictures ? SheetPictures{.missing = "they were not wanted"}
                                           : sheet_pictures(run.setup, zeros_of(content));
    if (auto written = write_output(options.output, html_sheet(run, content), read); !written)
        return tl::unexpected(written.error());
    if (content.tolerances_were_stopped) return ExitCode::failed;
    return run.has_errors() ? ExitCode::findings : ExitCode::clear;
}

ExitCode sheet(const SheetOptions& options) {
    const auto written = write_sheet(options);
    return written ? *written : failed(written.error());
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

#include <memory>

#include <CLI/CLI.hpp>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/commands/commands.h"
#include "app/commands/interrupt.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/progress.h"
#include "app/commands/read_files.h"
#include "app/commands/suggestion.h"
#include "app/report/text/diff_report.h"

namespace app {
namespace {

struct DiffOptions {
    CheckArguments what; // the earlier version
    std::string later, later_setup, output, format = "text";
    bool blocks = false;
};

core::Result<CheckRun> checked(CheckJob job) {
    ProgressLine line;
    job.after_block = [&line](const CheckProgress& progress) {
        line.show(progress);
        return !is_interrupted();
    };
    auto run = run_check(job);
    line.clear();
    if (run && run->stopped) print_error(*run->stopped);
    return run;
}

core::Result<ExitCode> compare(const DiffOptions& options) {
    const ReadFiles read;
    FEELER_TRY(CheckJob job, job_of(options.what));
    CheckJob later = job;
    if (!options.later.empty()) later.program = options.later;
    if (!options.later_setup.empty()) later.setup = options.later_setup;
    if (later.program == job.program && later.setup == job.setup)
        return core::fail(core::ErrorCode::missing_value,
                          "nothing to compare with: give a second program, or a second set-up "
                          "with --setup-b");
    if (auto safe =
            check_output(options.output, {job.program, job.setup, later.program, later.setup});
        !safe)
        return tl::unexpected(safe.error());
    stop_on_interrupt();
    FEELER_TRY(const CheckRun before, checked(job));
    if (is_interrupted()) return ExitCode::failed;
    FEELER_TRY(const CheckRun after, checked(later));
    const ProgramDiff diff = diff_of(before, after, job.setup, later.setup);
    const std::string report =
        options.format == "json" ? diff_json(diff) : diff_text(diff, options.blocks);
    if (auto written = write_output(options.output, report, read); !written)
        return tl::unexpected(written.error());
    if (before.stopped || after.stopped) return ExitCode::failed;
    return diff.is_worse() ? ExitCode::findings : ExitCode::clear;
}

ExitCode diff(const DiffOptions& options) {
    const auto compared = compare(options);
    if (compared) return *compared;
    return failed(compared.error());
}

} // namespace

void add_diff(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<DiffOptions>();
    CLI::App& command = *cli.add_subcommand(
        "diff", "Compare two versions of a program, or of its set-up, block by block");
    add_check_arguments(command, options->what)->required();
    add_path(command, "later", options->later,
             "Later version of the program; default: the same file");
    add_path(command, "--setup-b", options->later_setup,
             "Set-up of the later version; default: that of the earlier one");
    command.add_option("--format", options->format, "text or json")
        ->check(one_of({"text", "json"}))
        ->capture_default_str();
    add_path(command, "-o,--output", options->output, "Write the report to this file");
    command.add_flag("--blocks", options->blocks, "Text report: all blocks instead of the worst");
    command.callback([options, &exit_code] { exit_code = diff(*options); });
}

} // namespace app

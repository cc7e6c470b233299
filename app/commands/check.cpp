#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/conclusion.h"
#include "app/check/stock_file.h"
#include "app/commands/check_options.h"
#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/progress.h"
#include "app/commands/read_files.h"
#include "app/commands/report_formats.h"
#include "app/commands/suggestion.h"
#include "app/library/find/project_file.h"
#include "app/library/result/batch_result.h"
#include "app/library/run/batch_job.h"
#include "app/library/watch/watched_files.h"
#include "app/report/html/html_report.h"
#include "app/report/html/pictured_run.h"
#include "app/report/text/batch_text.h"
#include "app/setup/coverage.h"
#include "app/tolerance/tolerances.h"

namespace app {

/// Runs a check, then repeats it whenever a file or folder that it accessed changes, until Ctrl-C.
/// `pass` passes file accesses made on other threads to the WatchedFiles; those of its own thread
/// are observed. `outputs`: paths of the reports and results; those that a pass cannot rewrite are
/// deleted. Returns the result of the last pass.
ExitCode watch(const std::vector<std::string>& outputs,
               const std::function<ExitCode(WatchedFiles&)>& pass);

namespace {

/// The content of the reports, and the files that they must not replace.
struct Checked {
    ProgramReport report;
    const ReadFiles& read;
};

/// Writes a report piece by piece: that of a long program is larger than its record.
core::Result<void> write_report(const ReportTarget& target, const Checked& checked) {
    if (auto safe = checked.read.check(target.path); !safe) return safe;
    FEELER_TRY(OutputStream stream, OutputStream::open(target.path));
    ProgramReport report = checked.report;
    if (!target.path.empty()) {
        report.shown_assumptions.clear(); // a file lists all assumptions
    } else {
        const TerminalStyle style = terminal_style(stdout);
        report.width = style.width;
        report.colour = style.colour;
    }
    core::Result<void> written;
    report_format(target.format).of_program(report, [&](std::string_view piece) {
        if (written) written = stream.write(piece);
    });
    if (!written) return written;
    return stream.finish();
}

/// Checks before the run, as far as possible, that the output files can be written.
core::Result<void> check_files(const CheckOptions& options,
                               const std::vector<ReportTarget>& targets, const ReadFiles& read) {
    if (auto safe = read.check(paths_of(targets)); !safe) return safe;
    for (const std::string& name : {options.stock, options.comparison}) {
        if (name.empty()) continue;
        if (auto safe = read.check(name); !safe) return safe;
        for (const ReportTarget& target : targets)
            if (auto safe = check_output(name, {target.path}); !safe) return safe;
        if (auto form = mesh_form(name); !form) return tl::unexpected(form.error());
    }
    if (options.stock.empty()) return {};
    return check_output(options.stock, {options.comparison});
}

/// Writes the files requested in addition to the reports: remaining stock and comparison.
core::Result<void> save_results(const CheckOptions& options, CheckRun& run, const ReadFiles& read) {
    for (const std::string& name : {options.stock, options.comparison})
        if (!name.empty() && run.stopped)
            return tl::unexpected<core::Error>(
                {core::ErrorCode::invalid_value,
                 {},
                 "was not written: the program did not run to its end",
                 name});
    if (!options.stock.empty()) {
        FEELER_TRY(const MeshForm form, mesh_form(options.stock));
        FEELER_TRY(const StockFile file,
                   form == MeshForm::record
                       ? stock_record_file(*run.stock, run.stock_error, options.stock)
                       : stock_file(*run.surface, run.setup.mesh_size, options.stock));
        if (auto written = write_output(options.stock, file.bytes, read); !written) return written;
        run.saved_stock = std::make_shared<const SavedStock>(file.facts);
    }
    if (options.comparison.empty()) return {};
    FEELER_TRY(const std::string bytes, comparison_file(run, options.comparison));
    return write_output(options.comparison, bytes, read);
}

/// Prints the memory that the check needs if it is large.
bool say_memory(double bytes) {
    constexpr double much = 1e9;
    if (bytes >= much)
        print_note(fmt::format("the check takes about {:.1f} GB of memory\n", 1e-9 * bytes));
    return true;
}

/// Whether a report must not replace a file because the run was incomplete: it would look like a
/// report of the whole program.
bool is_held_back(const CheckOptions& options, const ReportTarget& target, const CheckRun& run) {
    if (!run.stopped || target.path.empty()) return false;
    const UnfinishedReport unfinished = report_format(target.format).unfinished;
    return unfinished == UnfinishedReport::never
           || (unfinished == UnfinishedReport::when_watching && !options.watch);
}

/// Writes the reports; false if one could not be written. If some are withheld, prints a text
/// report to standard output instead.
bool write_reports(const CheckOptions& options, const Checked& checked,
                   const std::vector<ReportTarget>& targets) {
    std::vector<ReportTarget> written;
    for (const ReportTarget& target : targets)
        if (!is_held_back(options, target, checked.report.run)) written.push_back(target);
    const bool is_on_screen = std::any_of(written.begin(), written.end(),
                                          [](const auto& target) { return target.path.empty(); });
    if (written.size() < targets.size() && !is_on_screen) written.push_back({"text", {}});
    bool all = true;
    for (const ReportTarget& target : written) {
        const auto done = write_report(target, checked);
        if (!done) print_error(done.error());
        all = all && done.has_value();
    }
    return all;
}

/// Prints the error, and writes the report formats that can record a check that could not start.
ExitCode fail(const CheckJob& job, const core::Error& error,
              const std::vector<ReportTarget>& targets, const ReadFiles& read) {
    print_error(error);
    BatchResult batch;
    batch.programs.push_back(failed_result(job, error));
    for (const ReportTarget& target : targets) {
        const ReportFormat& format = report_format(target.format);
        if (format.unfinished != UnfinishedReport::always) continue;
        const auto written = write_output(target.path, format.of_batch(batch, {}), read);
        if (!written) print_error(written.error());
    }
    return ExitCode::failed;
}

core::Result<CheckJob> one_job(const CheckOptions& options) {
    CheckOptions one = options;
    one.what.program = options.programs[0];
    FEELER_TRY(CheckJob job, job_of(one));
    if (options.jobs) job.threads = *options.jobs;
    job.needs_surface = !options.stock.empty() || !options.comparison.empty();
    job.before_model = say_memory;
    job.is_stopped = is_interrupted;
    return job;
}

/// Project files do not apply to a program named on the command line. If its set-up is inferred
/// although a project file covers it, prints a note.
void say_project(const CheckJob& job) {
    std::error_code ignored;
    if (!job.setup.empty() || !std::filesystem::is_regular_file(job.program, ignored)) return;
    const std::string project = ProjectOwners().of(resolved_path(job.program).parent_path(), "/");
    if (!project.empty())
        print_note(fmt::format("feeler: {} does not apply to a program that is named directly: "
                               "to use it, check the folder\n",
                               project));
}

/// `shown_assumptions`: the assumptions already shown on the terminal; replaced by those of this
/// check.
ExitCode check_one(const CheckOptions& options, const std::vector<ReportTarget>& targets,
                   std::vector<std::string>& shown_assumptions) {
    ReadFiles read;
    auto job = one_job(options);
    if (!job) return failed(job.error());
    read.add(job->program);
    read.add(job->setup);
    if (const auto safe = check_files(options, targets, read); !safe) return failed(safe.error());
    say_project(*job);
    stop_on_interrupt();
    ProgressLine line;
    job->after_block = [&line](const CheckProgress& progress) {
        line.show(progress);
        return !is_interrupted();
    };
    ReportViews views;
    const bool is_pictured = options.engine == Engine::exact
                             && std::any_of(targets.begin(), targets.end(), [](const auto& target) {
                                    return target.format == "html";
                                });
    auto run = is_pictured ? run_pictured_check(*job, views) : run_check(*job);
    line.clear();
    if (!run) return fail(*job, run.error(), targets, read);
    if (run->stopped) print_error(*run->stopped);
    if (options.tolerances) {
        auto tolerances = tolerances_of(*job, *run, [](double) { return !is_interrupted(); });
        if (!tolerances) return fail(*job, tolerances.error(), targets, read);
        run->tolerances = std::make_shared<const Tolerances>(*std::move(tolerances));
    }
    const bool is_cut_short = options.tolerances && is_interrupted();
    const auto saved = save_results(options, *run, read);
    if (!saved) print_error(saved.error());
    const bool all_written = write_reports(options,
                                           {{.run = *run,
                                             .setup = job->setup,
                                             .views = views,
                                             .blocks = options.blocks,
                                             .pairs = options.pairs,
                                             .shown_assumptions = shown_assumptions},
                                            read},
                                           targets);
    shown_assumptions = run->all_assumptions();
    if (!all_written || run->stopped || !saved || is_cut_short) return ExitCode::failed;
    return run->has_errors() ? ExitCode::findings : ExitCode::clear;
}

core::Result<void> check_shard_option(const CheckOptions& options) {
    const bool is_written = std::count(options.formats.begin(), options.formats.end(), "shard") > 0;
    if (options.shard || !is_written) return {};
    return core::fail(core::ErrorCode::invalid_value,
                      "--format shard needs --shard I/N: the shard that this computer checks");
}

bool is_batch(const CheckOptions& options) {
    return options.shard || !is_one_program(options.programs);
}

ExitCode check(const CheckOptions& options) {
    const auto targets = targets_of(options.formats, options.outputs);
    if (!targets) return failed(targets.error());
    if (auto fits = check_shard_option(options); !fits) return failed(fits.error());
    BatchPass many; // set once needed: while watching, a path may become a folder
    const auto prepare = [&](bool is_many) -> core::Result<void> {
        if (!is_many || many) return {};
        FEELER_TRY(many, batch_pass(options, *targets));
        return {};
    };
    if (auto ready = prepare(is_batch(options)); !ready) return failed(ready.error());
    std::vector<std::string> shown_assumptions;
    const auto pass = [&](WatchedFiles* files) {
        const bool is_many = is_batch(options);
        if (auto ready = prepare(is_many); !ready) return failed(ready.error());
        return is_many ? many(files) : check_one(options, *targets, shown_assumptions);
    };
    if (!options.watch) return pass(nullptr);
    std::vector<std::string> outputs = paths_of(*targets);
    outputs.insert(outputs.end(), {options.stock, options.comparison});
    return watch(outputs, [&](WatchedFiles& files) { return pass(&files); });
}

constexpr const char* examples = R"(
Examples:
  feeler check plate.nc                           what the program alone shows
  feeler check plate.nc --setup mill.toml         with machine, stock, fixtures and tools
  feeler check plate.nc --format html -o r.html   a report with pictures for any browser
  feeler check jobs/ --require coverage           many programs; status 1 also if a set-up lacks something)";

void add_report_options(CLI::App& command, CheckOptions& options) {
    const OptionGroup group(command, "Reports");
    command
        .add_option("--format", options.formats,
                    format_help(true) + "; repeat it with one -o each, in the same order")
        ->allow_extra_args(false)
        ->check(one_of(format_names(true)))
        ->default_str("text");
    add_path(command, "-o,--output", options.outputs, "Write the report to this file")
        ->allow_extra_args(false);
    add_path(command, "--save-stock", options.stock,
             "Write the remaining stock to this file: .stl, .ply, or .feeler as the "
             "stock of a later set-up");
    add_path(command, "--save-comparison", options.comparison,
             "Write the remaining stock, coloured by its deviation from the part (.ply)");
    command.add_flag("--blocks", options.blocks,
                     "Text report: add a table of all blocks that move");
    CLI::Option* quiet = command.add_flag(
        "--quiet", options.quiet, "Many programs: list only those with errors, and the summary");
    command
        .add_flag("--verbose", options.verbose,
                  "Many programs: also list warnings, notes, assumptions and all skipped files")
        ->excludes(quiet);
}

void add_batch_options(CLI::App& command, CheckOptions& options) {
    const OptionGroup group(command, "Many programs");
    CLI::Option* cache =
        add_path(command, "--cache", options.cache,
                 "Many programs: database of results; unchanged programs are not checked again. "
                 "Default: .feeler/results.db in the folder, or next to the project file");
    command
        .add_flag("--no-cache", options.no_cache,
                  "Many programs: check all of them and store no results")
        ->excludes(cache);
    command
        .add_option_function<std::string>(
            "--shard", [&options](const std::string& name) { options.shard = *shard_named(name); },
            "Several computers: check only shard I of N; use --format shard and feeler merge")
        ->check(CLI::Validator(
            [](const std::string& name) {
                const auto shard = shard_named(name);
                return shard ? std::string() : shard.error().message;
            },
            "I/N"));
    command
        .add_option("-j,--jobs", options.jobs,
                    "Number of threads, for programs that run in parallel and within a program; "
                    "default one per core")
        ->check(number_range(1.0, 1024.0));
    command
        .add_option("--memory", options.memory,
                    "Many programs: total memory of the programs that run in parallel, MB; "
                    "default half of the computer's")
        ->check(number_range(1.0, 1e9));
}

void add_watch(CLI::App& command, CheckOptions& options) {
    const OptionGroup group(command, "How to check");
    command.add_flag("--watch", options.watch,
                     "Check again whenever a program, a set-up or a file they use changes, "
                     "until Ctrl-C");
}

} // namespace

void add_check(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<CheckOptions>();
    CLI::App& command = *cli.add_subcommand("check", "Report the clearance of every block");
    add_path(command, "program", options->programs,
             "NC programs: files, folders, patterns in quotes, project files (.toml)")
        ->required();
    add_check_options(command, options->what);
    add_start_line(command, options->what);
    add_report_options(command, *options);
    add_batch_options(command, *options);
    add_watch(command, *options);
    command.footer(examples);
    {
        const OptionGroup group(command, "Set-up, clearances and limits");
        add_require_option(command, *options);
    }
    CLI::Option* pairs = command.add_flag("--pairs", options->pairs,
                                          "JSON: list every pair of bodies in every block");
    pairs->group("Reports");
    const OptionGroup group(command, "How to check");
    command
        .add_option_function<std::string>(
            "--engine",
            [options](const std::string& name) {
                options->engine =
                    name == name_of(Engine::exact) ? Engine::exact : Engine::coprocessor;
            },
            "Engine that measures: exact, or coprocessor (see feeler coproc)")
        ->check(one_of({name_of(Engine::exact), name_of(Engine::coprocessor)}))
        ->default_str(name_of(Engine::exact));
    command
        .add_flag("--verdict-only", options->verdict_only,
                  "Faster: no exact clearance for blocks that a bound proves clear")
        ->excludes(pairs);
    command.add_flag("--tolerances", options->tolerances,
                     "Also find how far each value of the set-up may deviate; takes some hundred "
                     "times as long");
    command.callback([options, &exit_code] { exit_code = check(*options); });
}

namespace {

using Clock = WatchPace::Clock;
using namespace std::chrono_literals;

void wait(Clock::duration duration) {
    const Clock::time_point end = Clock::now() + duration;
    while (!is_interrupted() && Clock::now() < end)
        std::this_thread::sleep_for(std::min<Clock::duration>(50ms, end - Clock::now()));
}

/// Waits for changes that have settled. Returns the changed paths; empty after Ctrl-C.
std::vector<std::string> wait_for_change(WatchedFiles& files) {
    WatchPace pace(Clock::now());
    while (true) {
        wait(pace.pause());
        if (is_interrupted()) return {};
        const Clock::time_point begin = Clock::now();
        WatchedFiles::Change change = files.poll();
        if (pace.is_time(change, begin, Clock::now() - begin)) return std::move(change.paths);
    }
}

std::string name_of(const std::string& path_text) {
    const std::filesystem::path path(path_text);
    return (path.has_filename() ? path.filename() : path).generic_string();
}

/// The file names, with the folder if two are equal.
std::string names_of(const std::vector<std::string>& paths) {
    constexpr size_t most = 3;
    std::map<std::string, size_t> counts;
    for (const std::string& path : paths) ++counts[name_of(path)];
    std::vector<std::string> names;
    for (size_t i = 0; i < std::min(paths.size(), most); ++i) {
        const std::string name = name_of(paths[i]);
        names.push_back(counts[name] > 1 ? paths[i] : name);
    }
    std::string text = fmt::format("{}", fmt::join(names, ", "));
    if (paths.size() > most) text += fmt::format(" and {} more", paths.size() - most);
    return text;
}

void say(const std::string& text) {
    std::fflush(stdout);
    print_note(text);
}

} // namespace

ExitCode watch(const std::vector<std::string>& outputs,
               const std::function<ExitCode(WatchedFiles&)>& pass) {
    stop_on_interrupt();
    WatchedFiles files(outputs);
    WatchOutputs written(outputs);
    while (true) {
        files.begin_again();
        written.begin_pass();
        ExitCode code{};
        {
            const core::FileAccessObserver listening(
                [&files](const core::FileAccess& access) { files.note(access); });
            code = pass(files);
        }
        written.end_pass(files);
        if (is_interrupted()) return code;
        say(fmt::format("feeler: watching {}; Ctrl-C ends it\n", counted(files.size(), "place")));
        const std::vector<std::string> changed = wait_for_change(files);
        if (changed.empty()) return code;
        const std::time_t now = std::time(nullptr);
        say(fmt::format("\nfeeler: {:%H:%M:%S} {} changed\n", fmt::localtime(now),
                        names_of(changed)));
    }
}

} // namespace app

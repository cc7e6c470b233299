#include <memory>

#include <fmt/format.h>

#include "app/commands/check_arguments.h"
#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/progress.h"
#include "app/report/csv_report.h"
#include "app/report/json_report.h"
#include "app/report/text_report.h"
#include "app/session/part_check.h"

namespace app {
namespace {

struct Options {
    CheckArguments what;
    std::string output, stock, comparison, format = "text";
    Engine engine = Engine::exact;
    bool blocks = false;
    bool pairs = false;
    bool verdict_only = false;
};

std::string report(const Options& options, const CheckRun& run) {
    if (options.format == "csv") return csv_report(run);
    if (options.format == "jsonl") return json_lines_report(run, options.pairs);
    if (options.format == "json") return json_report(run, options.pairs);
    return text_report(run, {.blocks = options.blocks || options.pairs});
}

/// Whether what is to be written can be, as far as that is known beforehand.
core::Result<void> check_files(const Options& options) {
    if (auto safe = check_output(options.output, {options.what.program, options.what.setup}); !safe)
        return safe;
    for (const std::string& name : {options.stock, options.comparison}) {
        if (name.empty()) continue;
        if (auto safe =
                check_output(name, {options.what.program, options.what.setup, options.output});
            !safe)
            return safe;
        if (auto form = mesh_form(name); !form) return tl::unexpected(form.error());
    }
    if (options.stock.empty()) return {};
    return check_output(options.stock, {options.comparison});
}

/// Writes what was asked for beside the report.
core::Result<void> save_results(const Options& options, CheckRun& run) {
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
                       ? stock_record_file(*run.stock, options.stock)
                       : stock_file(*run.surface, run.setup.mesh_size, options.stock));
        if (auto written = write_output(options.stock, file.bytes); !written) return written;
        run.saved_stock = file.facts;
    }
    if (options.comparison.empty()) return {};
    FEELER_TRY(const std::string bytes, comparison_file(run, options.comparison));
    return write_output(options.comparison, bytes);
}

/// Before much memory is taken it is said how much.
bool say_memory(double bytes) {
    constexpr double much = 1e9;
    if (bytes >= much)
        std::fputs(
            fmt::format("the model of the stock takes about {:.1f} GB\n", 1e-9 * bytes).c_str(),
            stderr);
    return true;
}

core::Detail detail_of(const Options& options) {
    if (options.pairs) return core::Detail::every_pair;
    return options.verdict_only ? core::Detail::verdict : core::Detail::deciding_pair;
}

ExitCode check(const Options& options) {
    const auto safe = check_files(options);
    if (!safe) {
        print_error(safe.error());
        return ExitCode::failed;
    }
    auto job = job_of(options.what);
    if (!job) {
        print_error(job.error());
        return ExitCode::failed;
    }
    stop_on_interrupt();
    ProgressLine line;
    job->detail = detail_of(options);
    job->engine = options.engine;
    job->needs_surface = !options.stock.empty() || !options.comparison.empty();
    job->before_model = say_memory;
    job->after_block = [&line](const CheckProgress& progress) {
        line.show(progress);
        return !is_interrupted();
    };
    auto run = run_check(*job);
    line.clear();
    if (!run) {
        print_error(run.error());
        return ExitCode::failed;
    }
    if (run->stopped) print_error(*run->stopped);
    const auto saved = save_results(options, *run);
    if (!saved) print_error(saved.error());
    // A run that did not come to its end goes to standard output: a file would look like a whole
    // one.
    const auto written = write_output(run->stopped ? "" : options.output, report(options, *run));
    if (!written) {
        print_error(written.error());
        return ExitCode::failed;
    }
    if (run->stopped || !saved) return ExitCode::failed;
    return run->has_errors() ? ExitCode::findings : ExitCode::clear;
}

} // namespace

void add_check(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<Options>();
    CLI::App& command = *cli.add_subcommand("check", "Report the clearance of every block");
    add_check_arguments(command, options->what)->required();
    add_start_line(command, options->what);
    command
        .add_option("--format", options->format,
                    "text, json, jsonl (an object to a line) or csv (a row to a block)")
        ->check(CLI::IsMember({"text", "json", "jsonl", "csv"}))
        ->capture_default_str();
    command.add_option("-o,--output", options->output, "Write the report to this file");
    command.add_option("--save-stock", options->stock,
                       "Write what is left of the stock to this file (.stl, .ply, or .feeler "
                       "for a later set-up)");
    command.add_option("--save-comparison", options->comparison,
                       "Write what is left, coloured by its deviation from the part (.ply)");
    command.add_flag("--blocks", options->blocks, "Text: add the table of all blocks that move");
    CLI::Option* pairs = command.add_flag("--pairs", options->pairs,
                                          "JSON: add every pair of bodies to every block");
    command
        .add_option("--engine", options->engine,
                    "Who measures: exact, or coprocessor (feeler coproc says what it is)")
        ->transform(CLI::CheckedTransformer(std::map<std::string, Engine>{
            {"exact", Engine::exact}, {"coprocessor", Engine::coprocessor}}))
        ->option_text("exact|coprocessor");
    command
        .add_flag("--verdict-only", options->verdict_only,
                  "Faster: no clearance of blocks that a bound already clears")
        ->excludes(pairs);
    command.callback([options, &exit_code] { exit_code = check(*options); });
}

} // namespace app

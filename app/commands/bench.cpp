#include <memory>

#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/suggestion.h"
#include "app/report/text/bench_report.h"

namespace app {
namespace {

struct BenchOptions {
    std::string tables, output;
    std::string format = "text";
};

core::Result<void> bench_paper(const BenchOptions& options) {
    std::vector<BenchTable> tables;
    for (const BenchScene& scene : bench_scenes()) {
        FEELER_TRY(BenchTable table, measure(scene));
        tables.push_back(std::move(table));
    }
    return write_output(options.output,
                        options.format == "csv" ? csv_bench(tables) : text_bench(tables));
}

ExitCode run_bench(const BenchOptions& options) {
    const auto done = bench_paper(options);
    if (done) return ExitCode::clear;
    return failed(done.error());
}

} // namespace

void add_bench(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<BenchOptions>();
    CLI::App& command =
        *cli.add_subcommand("bench", "Time the searches for the closest pair of points");
    command
        .add_option("tables", options->tables,
                    "paper: the cases of Uddin and Yamazaki (2010), with both engines")
        ->required()
        ->check(one_of({"paper"}));
    command.add_option("--format", options->format, "text or csv")
        ->check(one_of({"text", "csv"}))
        ->capture_default_str();
    add_path(command, "-o,--output", options->output, "Write the tables to this file");
    command.callback([options, &exit_code] { exit_code = run_bench(*options); });
}

} // namespace app

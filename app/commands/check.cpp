#include <memory>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/number_range.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/report/json_report.h"
#include "app/report/text_report.h"

namespace app {
namespace {

struct Options {
    std::string program, setup, output;
    ProgramArguments reading;
    std::string format = "text";
    std::optional<double> allowance, mesh_size;
    bool blocks = false;
    bool pairs = false;
};

std::string report(const Options& options, const CheckRun& run) {
    if (options.format == "json") return json_report(run, options.pairs);
    return text_report(run, {.blocks = options.blocks || options.pairs});
}

ExitCode check(const Options& options) {
    const auto safe = check_output(options.output, {options.program, options.setup});
    if (!safe) {
        print_error(safe.error());
        return ExitCode::failed;
    }
    const auto settings = settings_of(options.reading);
    if (!settings) {
        print_error(settings.error());
        return ExitCode::failed;
    }
    const auto run = run_check(
        {options.program, options.setup, options.allowance, options.mesh_size, *settings});
    if (!run) {
        print_error(run.error());
        return ExitCode::failed;
    }
    if (run->stopped) print_error(*run->stopped);
    // A run that did not come to its end goes to standard output: a file would look like a whole
    // one.
    const auto written = write_output(run->stopped ? "" : options.output, report(options, *run));
    if (!written) {
        print_error(written.error());
        return ExitCode::failed;
    }
    if (run->stopped) return ExitCode::failed;
    return run->has_errors() ? ExitCode::findings : ExitCode::clear;
}

} // namespace

void add_check(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<Options>();
    CLI::App& command = *cli.add_subcommand("check", "Report the clearance of every block");
    command.add_option("program", options->program, "NC program")->required();
    command.add_option("--setup", options->setup,
                       "Set-up file (TOML); else it is inferred from the program, and said");
    command
        .add_option("--allowance", options->allowance,
                    "Clearance to keep from fixtures, and of the holder from the stock, mm")
        ->check(number_range(0.0, 1000.0));
    command.add_option("--mesh-size", options->mesh_size, "Spacing of the scan lines, mm")
        ->check(number_range(1e-300, 1e300));
    add_program_arguments(command, options->reading);
    command.add_option("--format", options->format, "text or json")
        ->check(CLI::IsMember({"text", "json"}))
        ->capture_default_str();
    command.add_option("-o,--output", options->output, "Write the report to this file");
    command.add_flag("--blocks", options->blocks, "Text: add the table of all blocks that move");
    command.add_flag("--pairs", options->pairs, "JSON: add every pair of bodies to every block");
    command.callback([options, &exit_code] { exit_code = check(*options); });
}

} // namespace app

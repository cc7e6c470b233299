#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "app/batch/result_key.h"
#include "app/batch/store_file.h"
#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/report/history_report.h"

namespace app {
namespace {

struct Options {
    std::string program, cache, output, format = "text";
};

core::Result<std::string> place_of_store(const Options& options) {
    std::error_code failure;
    if (!options.cache.empty()) {
        if (std::filesystem::exists(options.cache, failure)) return options.cache;
        return tl::unexpected<core::Error>(
            {core::ErrorCode::io, {}, "there is no such file", options.cache});
    }
    if (auto found = store_above(options.program)) return *found;
    return core::fail(core::ErrorCode::io,
                      fmt::format("no folder above {} has results (.feeler/results.db): check its "
                                  "folder first, or name a database with --cache",
                                  options.program));
}

core::Result<void> write_history(const Options& options) {
    FEELER_TRY(const std::string place, place_of_store(options));
    if (auto safe = check_output(options.output, {options.program, place}); !safe) return safe;
    FEELER_TRY(ResultStore store, ResultStore::open(place, build_version()));
    FEELER_TRY(const std::vector<KeptVersion> versions, store.history(options.program));
    if (versions.empty())
        return core::fail(core::ErrorCode::missing_value,
                          fmt::format("{} has no results of {}", place, options.program));
    return write_output(options.output, options.format == "json"
                                            ? history_json(options.program, versions)
                                            : history_text(options.program, versions));
}

ExitCode history(const Options& options) {
    const auto written = write_history(options);
    if (written) return ExitCode::clear;
    print_error(written.error());
    return ExitCode::failed;
}

} // namespace

void add_history(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<Options>();
    CLI::App& command = *cli.add_subcommand(
        "history", "Show how a program's results changed from version to version");
    command.add_option("program", options->program, "NC program")->required();
    command.add_option("--cache", options->cache,
                       "Database of results; else .feeler/results.db of the nearest folder above");
    command.add_option("--format", options->format, "text or json")
        ->check(CLI::IsMember({"text", "json"}))
        ->capture_default_str();
    command.add_option("-o,--output", options->output, "Write the report to this file");
    command.callback([options, &exit_code] { exit_code = history(*options); });
}

} // namespace app

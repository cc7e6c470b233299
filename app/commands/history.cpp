#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/suggestion.h"
#include "app/library/store/result_key.h"
#include "app/library/store/store_file.h"
#include "app/report/history/history_report.h"

namespace app {
namespace {

struct HistoryOptions {
    std::string program, cache, output, format = "text";
};

core::Result<std::vector<std::string>> paths_of_stores(const HistoryOptions& options) {
    std::error_code failure;
    if (!options.cache.empty()) {
        if (std::filesystem::exists(options.cache, failure))
            return std::vector<std::string>{options.cache};
        return tl::unexpected<core::Error>(
            {core::ErrorCode::io, {}, "there is no such file", options.cache});
    }
    if (auto found = stores_above(options.program); !found.empty()) return found;
    return core::fail(core::ErrorCode::io,
                      fmt::format("no folder above {} has results (.feeler/results.db): check its "
                                  "folder first, or name a database with --cache",
                                  options.program));
}

/// Merges equal versions of several databases, which arise if a library is divided differently
/// among machines. The merged version was first checked and last seen at the extremes of its
/// copies.
std::vector<StoredVersion> joined(std::vector<StoredVersion> all) {
    std::map<std::vector<std::string>, size_t> paths;
    std::vector<StoredVersion> versions;
    for (StoredVersion& each : all) {
        const auto [at, is_new] = paths.try_emplace(
            {each.version, each.setup, each.options, each.inputs}, versions.size());
        if (is_new) {
            versions.push_back(std::move(each));
            continue;
        }
        StoredVersion& same = versions[at->second];
        same.checked_at = std::min(same.checked_at, each.checked_at);
        same.seen_at = std::max(same.seen_at, each.seen_at);
    }
    return versions;
}

/// All versions, the last seen at the end.
core::Result<std::vector<StoredVersion>> versions_in(const std::vector<std::string>& paths,
                                                     const std::string& program) {
    std::vector<ResultStore> stores;
    std::vector<StoredVersion> all;
    for (const std::string& path : paths) {
        FEELER_TRY(ResultStore store, ResultStore::open(path, build_version()));
        FEELER_TRY(std::vector<StoredVersion> versions, store.history(program));
        std::move(versions.begin(), versions.end(), std::back_inserter(all));
        stores.push_back(std::move(store));
    }
    for (StoredVersion& version : all) {
        for (ResultStore& store : stores) {
            FEELER_TRY(const int64_t seen, store.seen_at(version));
            version.seen_at = std::max(version.seen_at, seen);
        }
    }
    std::vector<StoredVersion> versions = joined(std::move(all));
    std::stable_sort(
        versions.begin(), versions.end(),
        [](const StoredVersion& a, const StoredVersion& b) { return a.seen_at < b.seen_at; });
    return versions;
}

core::Result<void> write_history(const HistoryOptions& options) {
    FEELER_TRY(const std::vector<std::string> paths, paths_of_stores(options));
    if (auto safe = check_output(options.output, {options.program}); !safe) return safe;
    for (const std::string& path : paths)
        if (auto safe = check_output(options.output, {path}); !safe) return safe;
    FEELER_TRY(const std::vector<StoredVersion> versions, versions_in(paths, options.program));
    if (versions.empty())
        return core::fail(core::ErrorCode::missing_value,
                          fmt::format("{} has no results for {}", paths[0], options.program));
    return write_output(options.output, options.format == "json"
                                            ? history_json(options.program, versions)
                                            : history_text(options.program, versions));
}

ExitCode history(const HistoryOptions& options) {
    const auto written = write_history(options);
    if (written) return ExitCode::clear;
    return failed(written.error());
}

} // namespace

void add_history(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<HistoryOptions>();
    CLI::App& command = *cli.add_subcommand(
        "history", "Show how the results of a program changed from version to version");
    add_path(command, "program", options->program, "NC program")->required();
    add_path(command, "--cache", options->cache,
             "Database of results; default: .feeler/results.db in the nearest folder above");
    command.add_option("--format", options->format, "text or json")
        ->check(one_of({"text", "json"}))
        ->capture_default_str();
    add_path(command, "-o,--output", options->output, "Write the report to this file");
    command.callback([options, &exit_code] { exit_code = history(*options); });
}

} // namespace app

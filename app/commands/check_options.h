#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/check/check_job.h"
#include "app/commands/commands.h"
#include "app/commands/program_arguments.h"
#include "app/library/store/shard_number.h"

namespace app {

class WatchedFiles;
enum class Engine : uint8_t;
struct CheckJob;

/// The options of `feeler check`, as words of a command line.
struct CheckOptions {
    CheckArguments what; // without a program
    std::vector<std::string> programs;
    std::vector<std::string> formats, outputs;
    std::string stock, comparison, cache;
    bool no_cache = false;
    Engine engine{}; // the exact one
    bool blocks = false;
    bool pairs = false;
    bool verdict_only = false;
    bool quiet = false;
    bool verbose = false;
    bool watch = false;
    std::optional<unsigned> jobs;
    std::optional<double> memory; // MB
    std::optional<ShardId> share; // of the programs; empty: all
};

/// A report to write.
struct ReportTarget {
    std::string format;
    std::string path; // empty: standard output
};

/// Each --format with its --output, in order; one format may go without, to standard output.
///
/// Errors: invalid_value when they do not pair up.
core::Result<std::vector<ReportTarget>> targets_of(const std::vector<std::string>& formats,
                                                   const std::vector<std::string>& outputs);

/// The check that the options ask for; its program is that of `what`.
///
/// Errors: those of settings_of.
core::Result<CheckJob> job_of(const CheckOptions& options);

/// Checks many programs, prints a line for each, and writes the reports. A later call prints a line
/// for each program that was checked again. The argument is null without --watch.
using BatchPass = std::function<ExitCode(WatchedFiles*)>;

/// The check of many programs. `options` and `targets` must outlive it.
core::Result<BatchPass> batch_pass(const CheckOptions& options,
                                   const std::vector<ReportTarget>& targets);

/// The files that the targets name.
std::vector<std::string> paths_of(const std::vector<ReportTarget>& targets);

} // namespace app

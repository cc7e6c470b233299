#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/check/check_job.h"
#include "app/commands/commands.h"
#include "app/commands/program_arguments.h"
#include "app/library/store/shard_number.h"

namespace CLI {
class App;
}

namespace app {

class WatchedFiles;
enum class Engine : uint8_t;
struct CheckJob;

/// The options of `feeler check`, as given on the command line.
struct CheckOptions {
    CheckArguments what; // without a program
    std::vector<std::string> programs;
    std::vector<std::string> formats, outputs;
    std::string stock, comparison, cache;
    std::vector<std::string> required; // of --require
    bool no_cache = false;
    Engine engine{}; // exact
    bool blocks = false;
    bool pairs = false;
    bool verdict_only = false;
    bool tolerances = false;
    bool quiet = false;
    bool verbose = false;
    bool watch = false;
    std::optional<unsigned> jobs;
    std::optional<double> memory; // MB
    std::optional<ShardId> shard; // of the programs; empty: all
};

/// A report to write.
struct ReportTarget {
    std::string format;
    std::string path; // empty: standard output
};

/// Pairs each --format with its --output, in order; one format may lack a file and goes to standard
/// output.
///
/// Errors: invalid_value if they do not pair up.
core::Result<std::vector<ReportTarget>> targets_of(const std::vector<std::string>& formats,
                                                   const std::vector<std::string>& outputs);

/// The check that the options describe, of the program in `what`.
///
/// Errors: those of settings_of.
core::Result<CheckJob> job_of(const CheckOptions& options);

/// Checks many programs, prints a line for each, and writes the reports. Later calls print a line
/// only for programs that were checked again. The argument is null without --watch.
using BatchPass = std::function<ExitCode(WatchedFiles*)>;

/// Prepares the check of many programs. `options` and `targets` must outlive it.
core::Result<BatchPass> batch_pass(const CheckOptions& options,
                                   const std::vector<ReportTarget>& targets);

/// Adds the option --require to a command.
void add_require_option(CLI::App& command, CheckOptions& options);

/// The file paths of the targets.
std::vector<std::string> paths_of(const std::vector<ReportTarget>& targets);

} // namespace app

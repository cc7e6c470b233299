#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/commands/batch_ending.h"
#include "app/commands/output.h"
#include "app/commands/progress.h"
#include "app/commands/report_formats.h"
#include "app/commands/suggestion.h"
#include "app/library/find/folder_walk.h"
#include "app/library/shard/shard.h"
#include "app/library/store/result_key.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"

namespace app {
namespace {

struct MergeOptions {
    std::vector<std::string> files, formats, outputs;
    BatchStyle style;
};

core::Result<Shard> read_shard(const std::string& file) {
    const auto refused = [&](core::Error error) {
        error.file = file;
        return tl::unexpected(std::move(error));
    };
    const auto bytes = core::file_bytes(file);
    if (!bytes)
        return refused(
            {core::ErrorCode::io, {}, std::string("cannot be read: ") + std::strerror(errno), {}});
    auto shard = shard_from_json(*bytes);
    if (!shard) return refused(shard.error());
    if (shard->version != build_version())
        return refused(
            {core::ErrorCode::unsupported,
             {},
             fmt::format("was written by feeler {}, but this is {}: merge with the same version",
                         shard->version, build_version()),
             {}});
    shard->file = file;
    return shard;
}

/// The files that words of the command line name; shells of Windows leave patterns alone.
std::vector<std::string> named_files(const std::vector<std::string>& words) {
    std::vector<std::string> files;
    for (const std::string& word : words) {
        std::error_code ignored;
        std::vector<std::string> found;
        if (is_glob(word) && !std::filesystem::exists(word, ignored))
            found = files_of_glob({}, word).files;
        if (found.empty()) found = {word};
        files.insert(files.end(), found.begin(), found.end());
    }
    return files;
}

core::Result<std::vector<Shard>> read_shards(const std::vector<std::string>& files) {
    std::vector<Shard> shards;
    for (const std::string& file : files) {
        FEELER_TRY(Shard shard, read_shard(file));
        shards.push_back(std::move(shard));
    }
    return shards;
}

/// Protects the inputs of the checks, named in the shards: a report must not replace them.
void add_inputs(const std::vector<Shard>& shards, ReadFiles& read) {
    for (const Shard& shard : shards) {
        for (const PlannedProgram& program : shard.programs) read.add(program.name);
        for (const ProgramResult& result : shard.results) {
            const auto add = [&](const std::string& name) {
                read.add(name_shown_as(name, result.file_bytes));
            };
            for (const std::string& name : {result.program, result.setup}) add(name);
            if (result.error) add(result.error->file);
            for (const StoredFinding& finding : result.findings) add(finding.file);
        }
    }
}

/// Prints what a single run of the batch would print.
void say_all(const BatchResult& batch, const std::vector<Shard>& shards, const BatchOutput& talk) {
    for (const ProgramResult& program : batch.programs) talk.say(program_text(program, talk.style));
    double seconds = 0.0;
    for (const Shard& shard : shards) seconds += shard.seconds;
    talk.say("\n" + batch_summary(batch, seconds, talk.style));
    for (const Shard& shard : shards)
        if (!shard.unchecked.empty())
            print_note(fmt::format("feeler: {}: shard {} was interrupted: run it again\n",
                                   shard.file, text_of(shard.id)));
}

core::Result<ExitCode> merge(const MergeOptions& options) {
    core::platform::ignore_broken_pipes();
    ReadFiles read;
    FEELER_TRY(const std::vector<ReportTarget> targets,
               targets_of(options.formats, options.outputs));
    const std::vector<std::string> files = named_files(options.files);
    for (const std::string& file : files) read.add(file);
    if (auto safe = read.check(paths_of(targets)); !safe) return tl::unexpected(safe.error());
    FEELER_TRY(const std::vector<Shard> shards, read_shards(files));
    add_inputs(shards, read);
    if (auto safe = read.check(paths_of(targets)); !safe) return tl::unexpected(safe.error());
    FEELER_TRY(const BatchResult batch, merged(shards));
    const BatchOutput talk = output_for(options.style, targets);
    say_all(batch, shards, talk);
    return end_batch(batch, nullptr, targets, talk, read);
}

ExitCode merge_aloud(const MergeOptions& options) {
    const auto done = merge(options);
    if (done) return *done;
    return failed(done.error());
}

} // namespace

void add_merge(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<MergeOptions>();
    CLI::App& command = *cli.add_subcommand("merge", "Join the results of check --shard");
    add_path(command, "shard", options->files,
             "Files written by check --shard --format shard, one per shard")
        ->required();
    command
        .add_option("--format", options->formats,
                    format_help(false) + "; repeat it with one -o each, in the same order")
        ->allow_extra_args(false)
        ->check(one_of(format_names(false)))
        ->default_str("text");
    add_path(command, "-o,--output", options->outputs, "Write the report to this file")
        ->allow_extra_args(false);
    CLI::Option* quiet = command.add_flag("--quiet", options->style.quiet,
                                          "List only programs with errors, and the summary");
    command
        .add_flag("--verbose", options->style.verbose,
                  "Also list warnings, notes, assumptions and all skipped files")
        ->excludes(quiet);
    command.callback([options, &exit_code] { exit_code = merge_aloud(*options); });
}

} // namespace app

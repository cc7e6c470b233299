#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/base/sha256.h"
#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/commands/check_options.h"
#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/progress.h"
#include "app/commands/suggestion.h"
#include "app/guard/program_filter.h"
#include "app/guard/shell.h"
#include "app/library/store/database.h"
#include "app/library/store/result_key.h"
#include "app/library/store/result_store.h"
#include "app/setup/setup_file.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"

namespace app {
namespace {

struct FilterOptions {
    CheckOptions check;
    std::string then;
};

/// The folder for what filters keep; empty if this user has none.
std::filesystem::path filter_folder() {
    const std::filesystem::path folder = core::platform::state_folder();
    return folder.empty() ? folder : folder / "feeler" / "filter";
}

/// The results of earlier filters; null without a folder for them, and if they cannot be used.
std::unique_ptr<ResultStore> opened_store(const FilterOptions& options) {
    if (options.check.no_cache) return {};
    std::string path = options.check.cache;
    if (path.empty()) {
        const std::filesystem::path folder = filter_folder();
        std::error_code failure;
        if (!folder.empty()) std::filesystem::create_directories(folder, failure);
        if (folder.empty() || failure) return {};
        path = (folder / "results.db").string();
    }
    auto store =
        ResultStore::open(path, build_version(), std::make_shared<RetryBudget>(is_interrupted));
    if (store) return std::make_unique<ResultStore>(*std::move(store));
    print_error(store.error());
    return {};
}

/// The program that the control is to get.
struct FilteredProgram {
    std::string path; // of the file that is checked
    std::string bytes;
};

core::Result<FilteredProgram> read_program_file(const std::string& path) {
    if (const std::string why = core::why_no_file(path); !why.empty())
        return tl::unexpected(core::Error{core::ErrorCode::io, {}, why, path});
    auto bytes = core::file_bytes(path);
    if (bytes) return FilteredProgram{path, *std::move(bytes)};
    return tl::unexpected(core::Error{core::ErrorCode::io, {}, "cannot be read", path});
}

/// Runs the other filter, and keeps what it writes as a file of the same name: each program has a
/// folder of its own for it, so that an unchanged one is known again.
core::Result<FilteredProgram> filtered_before(const std::string& program,
                                              const std::string& command) {
    auto output = run_in_shell(command, program);
    if (!output) return tl::unexpected(core::in_file(output.error(), command));
    if (output->status != 0)
        return tl::unexpected(core::Error{core::ErrorCode::invalid_value,
                                          {},
                                          fmt::format("failed with status {}", output->status),
                                          command});
    const std::filesystem::path base = filter_folder();
    const std::filesystem::path folder =
        base / sha256_of(absolute_path(program)).substr(0, 16) / "";
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (base.empty() || failure)
        return tl::unexpected(core::Error{core::ErrorCode::io,
                                          {},
                                          "there is no folder for the program that it has written",
                                          command});
    const std::string path = (folder / std::filesystem::path(program).filename()).string();
    if (auto written = write_output(path, output->bytes); !written)
        return tl::unexpected(written.error());
    return FilteredProgram{path, std::move(output->bytes)};
}

/// The check of what the control is to get. LinuxCNC names its ini file in the environment.
core::Result<CheckJob> filter_job(const FilterOptions& options, const FilteredProgram& program) {
    CheckOptions check = options.check;
    const std::string original = check.what.program;
    check.what.program = program.path;
    if (const char* ini = std::getenv("INI_FILE_NAME"); ini && check.what.reading.ini.empty())
        check.what.reading.ini = ini;
    if (program.path != original) {
        if (check.what.setup.empty()) check.what.setup = setup_next_to(original);
        const auto folder = std::filesystem::path(absolute_path(original)).parent_path();
        check.what.reading.search_path.push_back(folder.string());
    }
    FEELER_TRY(CheckJob job, job_of(check));
    job.threads = std::max(1U, std::thread::hardware_concurrency());
    job.is_stopped = is_interrupted;
    return job;
}

core::Result<ExitCode> filter_program(const FilterOptions& options) {
    const std::string& original = options.check.what.program;
    FEELER_TRY(const FilteredProgram program, options.then.empty()
                                                  ? read_program_file(original)
                                                  : filtered_before(original, options.then));
    FEELER_TRY(CheckJob job, filter_job(options, program));
    FilterProgress progress;
    job.after_block = [&progress](const CheckProgress& now) {
        const std::string line = progress.line(now.fraction, FilterProgress::Clock::now());
        if (!line.empty()) std::fputs(line.c_str(), stderr);
        return !is_interrupted();
    };
    const std::unique_ptr<ResultStore> store = opened_store(options);
    FEELER_TRY(const ProgramResult result, filter_result(job, store.get()));
    if (!may_load(result)) {
        std::fputs(printable(refusal_text(result)).c_str(), stderr);
        return status_of(result) == 1 ? ExitCode::findings : ExitCode::failed;
    }
    if (result.sha256 != sha256_of(program.bytes))
        return tl::unexpected(core::Error{
            core::ErrorCode::io, {}, "changed while it was checked: load it again", original});
    std::fputs(printable(passing_text(result)).c_str(), stderr);
    FEELER_TRY(OutputStream output, OutputStream::open({}));
    if (auto written = output.write(program.bytes); !written)
        return tl::unexpected(written.error());
    if (auto written = output.finish(); !written) return tl::unexpected(written.error());
    return ExitCode::clear;
}

ExitCode filter(const FilterOptions& options) {
    stop_on_interrupt();
    const auto done = filter_program(options);
    if (done) return *done;
    const ExitCode code = failed(done.error());
    print_note("The program is not loaded.\n");
    return code;
}

constexpr const char* filter_examples = R"(
In the ini file of LinuxCNC:
  [FILTER]
  PROGRAM_EXTENSION = .ngc NC programs
  ngc = feeler filter --setup /home/me/mill.toml)";

} // namespace

void add_filter(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<FilterOptions>();
    CLI::App& command = *cli.add_subcommand(
        "filter", "Check a program as LinuxCNC loads it, and pass it on only without errors");
    CheckOptions& check = options->check;
    add_check_arguments(command, check.what)->required();
    add_require_option(command, check);
    command.add_option("--then", options->then,
                       "The filter that the ini file had before: it gets the program, and Feeler "
                       "checks and passes on what it writes");
    CLI::Option* cache = add_path(command, "--cache", check.cache,
                                  "Database of results: an unchanged program is not checked again. "
                                  "Default: in the folder for the state of programs");
    command.add_flag("--no-cache", check.no_cache, "Check the program anew and store no result")
        ->excludes(cache);
    command.footer(filter_examples);
    command.callback([options, &exit_code] { exit_code = filter(*options); });
}

} // namespace app

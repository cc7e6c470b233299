#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

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
#include "app/commands/setup_control.h"
#include "app/commands/suggestion.h"
#include "app/guard/program_filter.h"
#include "app/guard/shell.h"
#include "app/library/store/database.h"
#include "app/library/store/result_key.h"
#include "app/library/store/result_store.h"
#include "app/setup/control/offset_differences.h"
#include "app/setup/ini_file.h"
#include "app/setup/setup_file.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"

namespace app {
namespace {

struct FilterOptions {
    CheckOptions check;
    std::string then;
};

/// The folder for what filters keep, made if it is not there; empty if this user can have none.
std::filesystem::path filter_folder() {
    const std::filesystem::path state = core::platform::state_folder();
    if (state.empty()) return {};
    const std::filesystem::path folder = state / "feeler" / "filter";
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    return failure ? std::filesystem::path() : folder;
}

/// The results of earlier filters; null without a folder for them, and if they cannot be used.
std::unique_ptr<ResultStore> opened_store(const FilterOptions& options) {
    if (options.check.no_cache) return {};
    std::string path = options.check.cache;
    if (path.empty()) {
        const std::filesystem::path folder = filter_folder();
        if (folder.empty()) return {};
        path = (folder / "results.db").string();
    }
    auto store =
        ResultStore::open(path, build_version(), std::make_shared<RetryBudget>(is_interrupted));
    if (store) return std::make_unique<ResultStore>(*std::move(store));
    print_error(store.error());
    return {};
}

/// The program that the control is to get: the file, or what another filter makes of it.
class FilteredProgram {
public:
    /// Errors: io and those of the other filter.
    static core::Result<FilteredProgram> of_file(const std::string& program);
    static core::Result<FilteredProgram> of_filter(const std::string& program,
                                                   const std::string& command);

    FilteredProgram(FilteredProgram&& other) noexcept
        : path(std::move(other.path)),
          bytes(std::move(other.bytes)),
          copy_(std::exchange(other.copy_, {})) {}
    FilteredProgram& operator=(FilteredProgram&&) = delete;
    ~FilteredProgram() {
        std::error_code ignored;
        if (!copy_.empty()) std::filesystem::remove_all(copy_, ignored);
    }

    std::string path; // of the file that is checked
    std::string bytes;

private:
    FilteredProgram(std::string file, std::string contents, std::filesystem::path copy)
        : path(std::move(file)), bytes(std::move(contents)), copy_(std::move(copy)) {}

    std::filesystem::path copy_; // the folder of that file, if it is a copy
};

core::Result<FilteredProgram> FilteredProgram::of_file(const std::string& program) {
    if (const std::string why = core::why_no_file(program); !why.empty())
        return tl::unexpected(core::Error{core::ErrorCode::io, {}, why, program});
    auto bytes = core::file_bytes(program);
    if (bytes) return FilteredProgram(program, *std::move(bytes), {});
    return tl::unexpected(core::Error{core::ErrorCode::io, {}, "cannot be read", program});
}

constexpr const char* owner_file = ".owner"; // holds the number of the filter's process

/// Whether the filter that made a folder was killed. Until it has written its number, nobody knows.
bool is_left_behind(const std::filesystem::path& folder) {
    constexpr std::chrono::hours longest(24);
    std::error_code failure;
    const auto made_at = std::filesystem::last_write_time(folder, failure);
    if (failure) return false;
    if (std::filesystem::file_time_type::clock::now() - made_at > longest) return true;
    const auto owner = core::file_bytes(folder / owner_file, 32);
    const unsigned long number = owner ? std::strtoul(owner->c_str(), nullptr, 10) : 0;
    return number != 0 && !core::platform::is_running(static_cast<unsigned>(number));
}

/// An empty folder for the copy of a program; empty if there is none. It is the same each time, so
/// that the result of an unchanged copy is found again, unless another filter of the program runs.
std::filesystem::path fresh_folder(const std::string& program) {
    namespace fs = std::filesystem;
    const fs::path base = filter_folder();
    if (base.empty()) return {};
    std::error_code failure;
    const fs::path usual = base / sha256_of(absolute_path(program)).substr(0, 16);
    if (is_left_behind(usual)) fs::remove_all(usual, failure);
    if (fs::create_directory(usual, failure)) {
        std::ofstream(usual / owner_file) << core::platform::process_id();
        return usual;
    }
    fs::path other = usual;
    other += fmt::format("-{}", core::platform::process_id());
    fs::remove_all(other, failure);
    return fs::create_directory(other, failure) ? other : fs::path();
}

/// What the other filter writes becomes a file of the same name in a folder of its own, as in the
/// window: subprograms next to the program are not next to it.
core::Result<FilteredProgram> FilteredProgram::of_filter(const std::string& program,
                                                         const std::string& command) {
    const auto refuse = [&](core::ErrorCode code, const std::string& why) {
        return tl::unexpected(core::Error{code, {}, why, command});
    };
    auto output = run_in_shell(command, program);
    if (!output) return tl::unexpected(core::in_file(output.error(), command));
    if (output->status != 0)
        return refuse(core::ErrorCode::invalid_value,
                      fmt::format("failed with status {}", output->status));
    if (output->bytes.empty())
        return refuse(core::ErrorCode::invalid_value,
                      fmt::format("has written nothing for {}", program));
    const std::filesystem::path folder = fresh_folder(program);
    if (folder.empty())
        return refuse(core::ErrorCode::io, "there is no folder for what it has written: set HOME "
                                           "or XDG_STATE_HOME to one that can be written");
    const std::string path = (folder / std::filesystem::path(program).filename()).string();
    FilteredProgram filtered(path, std::move(output->bytes), folder);
    if (auto written = write_output(path, filtered.bytes); !written)
        return tl::unexpected(written.error());
    return filtered;
}

/// The check of what the control is to get. LinuxCNC names its ini file in the environment.
core::Result<CheckJob> filter_job(const FilterOptions& options, const FilteredProgram& program) {
    CheckOptions check = options.check;
    if (const char* ini = std::getenv("INI_FILE_NAME"); ini && check.what.reading.ini.empty())
        check.what.reading.ini = ini;
    const bool is_copy = program.path != check.what.program;
    if (is_copy && check.what.setup.empty()) check.what.setup = setup_next_to(check.what.program);
    check.what.program = program.path;
    FEELER_TRY(CheckJob job, job_of(check));
    job.is_stopped = is_interrupted;
    return job;
}

/// The text with the program's own path in place of that of its copy.
std::string with_own_path(std::string text, const std::string& copy, const std::string& own) {
    for (size_t at = text.find(copy); copy != own && at != std::string::npos;
         at = text.find(copy, at + own.size()))
        text.replace(at, copy.size(), own);
    return text;
}

/// The result with the program's own path in place of that of its copy.
ProgramResult with_own_path(ProgramResult result, const std::string& copy, const std::string& own) {
    result.program = own;
    if (!result.error) return result;
    if (result.error->file == copy) result.error->file = own;
    result.error->message = with_own_path(std::move(result.error->message), copy, own);
    return result;
}

core::Result<ExitCode> pass_on(const FilteredProgram& program, const ProgramResult& result,
                               const std::string& original) {
    if (result.sha256 != sha256_of(program.bytes))
        return tl::unexpected(core::Error{
            core::ErrorCode::io, {}, "changed while it was checked: load it again", original});
    FEELER_TRY(OutputStream output, OutputStream::open({}));
    if (auto written = output.write(program.bytes); !written)
        return tl::unexpected(written.error());
    if (auto written = output.finish(); !written) return tl::unexpected(written.error());
    return ExitCode::clear;
}

/// How the work offsets that the program uses differ from those that LinuxCNC has stored, for the
/// operator; empty if they do not.
core::Result<std::string> offsets_elsewhere(const CheckJob& job) {
    std::string stored = job.settings.parameters;
    if (stored.empty() && !job.settings.ini.empty()) {
        FEELER_TRY(IniFile ini, read_ini(job.settings.ini));
        stored = std::move(ini.parameters);
    }
    if (stored.empty()) return std::string();
    FEELER_TRY(const OffsetComparison compared, comparison_of(job, {stored}));
    return text_of_other_offsets(compared);
}

core::Result<ExitCode> filter_program(const FilterOptions& options) {
    const std::string& original = options.check.what.program;
    FEELER_TRY(const FilteredProgram program,
               options.then.empty() ? FilteredProgram::of_file(original)
                                    : FilteredProgram::of_filter(original, options.then));
    FEELER_TRY(CheckJob job, filter_job(options, program));
    FilterProgress progress;
    job.after_block = [&progress](const CheckProgress& now) {
        const std::string line = progress.line(now.fraction, FilterProgress::Clock::now());
        if (!line.empty()) std::fputs(line.c_str(), stderr);
        return !is_interrupted();
    };
    const std::unique_ptr<ResultStore> store = opened_store(options);
    auto result = filter_result(job, store.get());
    if (!result) {
        core::Error error = result.error();
        error.message = with_own_path(std::move(error.message), program.path, original);
        if (error.file == program.path) error.file = original;
        return tl::unexpected(std::move(error));
    }
    const bool passes = may_load(*result);
    if (passes && has_other_offsets(*result)) {
        FEELER_TRY(const std::string text, offsets_elsewhere(job));
        std::fputs(printable(text).c_str(), stderr);
        if (!text.empty()) return ExitCode::findings;
    }
    const ProgramResult shown = with_own_path(*result, program.path, original);
    const std::string text = passes ? passing_text(shown) : refusal_text(shown);
    std::fputs(printable(text).c_str(), stderr);
    if (passes) return pass_on(program, *result, original);
    return status_of(*result) == 1 ? ExitCode::findings : ExitCode::failed;
}

ExitCode filter(const FilterOptions& options) {
    stop_on_interrupt();
    const auto done = filter_program(options);
    if (done) return *done;
    const ExitCode code = failed(done.error());
    print_note(not_loaded);
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

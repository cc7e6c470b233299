#include "app/check/saved_setup.h"

#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/check/check_job.h"
#include "app/check/prepared_check.h"
#include "app/setup/setup_edits.h"
#include "app/setup/setup_text.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"

namespace app {
namespace {

namespace fs = std::filesystem;

core::Result<std::string> text_of_file(const std::string& path) {
    if (std::optional<std::string> text = core::file_bytes(path)) return *std::move(text);
    return tl::unexpected<core::Error>({core::ErrorCode::io, {}, "can no longer be read", path});
}

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

} // namespace

core::Result<std::string> setup_file_text(const CheckJob& job) {
    if (!job.setup.empty()) {
        FEELER_TRY(const std::string text, text_of_file(job.setup));
        return rewritten_setup(text, job.edits);
    }
    FEELER_TRY(PreparedCheck check, read_check(job));
    check.file.setup = std::move(check.run.setup);
    check.file.dialect = check.run.dialect;
    return setup_text(check.file, fs::path(job.program).filename().generic_string());
}

std::string proposed_setup_path(const CheckJob& job) {
    fs::path path(job.setup.empty() ? job.program : job.setup);
    if (!job.setup.empty())
        path.replace_filename(path.stem().generic_string() + "-edited.toml");
    else
        path.replace_extension(".toml");
    return path.generic_string();
}

core::Result<void> save_setup(const CheckJob& job, const std::string& path, bool may_replace,
                              const FileWriter& write) {
    std::error_code failure;
    if (path.empty()) return core::fail_file(path, "the file name is empty");
    if (core::platform::is_same_file(path, job.program))
        return core::fail_file(path, "is the program itself");
    if (!may_replace && fs::exists(path, failure)) return core::fail_file(path, "already exists");
    FEELER_TRY(const std::string text, setup_file_text(job));
    const bool is_elsewhere =
        !job.setup.empty() && !core::platform::is_same_file(folder_of(path), folder_of(job.setup));
    if (is_elsewhere && names_relative_files(text))
        return core::fail_file(
            path, fmt::format("the set-up names files by relative paths: save it in {}",
                              folder_of(job.setup).generic_string()));
    return write(path, text);
}

} // namespace app

#include "app/commands/pass_outputs.h"

#include <filesystem>

#include <fmt/format.h>

#include "app/commands/output.h"

namespace app {
namespace {

void take_away(const std::string& path) {
    std::error_code failure;
    const std::filesystem::path file = std::filesystem::canonical(path, failure); // behind a link
    if (!failure) std::filesystem::remove(file, failure);
    if (failure)
        print_error({core::ErrorCode::io,
                     {},
                     "tells of an earlier version, and cannot be taken away: " + failure.message(),
                     path});
    else
        print_note(
            fmt::format("feeler: {}: told of an earlier version, and is taken away\n", path));
}

} // namespace

PassOutputs::PassOutputs(const std::vector<std::string>& paths) {
    for (const std::string& path : paths)
        if (!path.empty()) outputs_.push_back({.path = path});
}

void PassOutputs::begin_pass() {
    for (Output& output : outputs_) output.before = written_stamp(output.path);
}

void PassOutputs::end_pass(const WatchedFiles& read) {
    for (const Output& output : outputs_) {
        const FileStamp written = written_stamp(output.path);
        const bool is_old = written.is_file && written == output.before;
        if (is_old && written == stamp_of(output.path) && !read.reads(output.path))
            take_away(output.path);
    }
}

} // namespace app

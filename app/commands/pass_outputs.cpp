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
    for (Output& output : outputs_) output.before = stamp_of(output.path);
}

void PassOutputs::end_pass() {
    for (Output& output : outputs_) {
        const FileStamp now = stamp_of(output.path);
        const bool is_new = now != output.before;
        if (!is_new && now.is_file && now == output.written) take_away(output.path);
        output.written = is_new ? now : FileStamp{};
    }
}

} // namespace app

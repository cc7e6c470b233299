#include "app/commands/read_files.h"

#include <filesystem>
#include <map>
#include <utility>

#include "app/base/file_stamp.h"
#include "app/commands/output.h"

namespace app {
namespace {

/// Device and inode of a file.
using FileNumber = std::pair<uint64_t, uint64_t>;

FileNumber number_of(const std::string& path) {
    const FileStamp stamp = stamp_of(path);
    return {stamp.device, stamp.number};
}

} // namespace

ReadFiles::ReadFiles() : listening_([this](const core::FileAccess& access) { note(access); }) {}

void ReadFiles::note(const core::FileAccess& access) {
    if (access.question == core::FileAccessKind::content) add(access.path);
}

void ReadFiles::add(const std::string& path) {
    if (path.empty()) return;
    const std::scoped_lock lock(mutex_);
    paths_.insert(path);
}

core::Result<void> ReadFiles::check(const std::string& output) const {
    return check(std::vector{output});
}

core::Result<void> ReadFiles::check(const std::vector<std::string>& outputs) const {
    std::map<FileNumber, std::string> there;
    std::error_code ignored;
    for (const std::string& output : outputs)
        if (!output.empty() && std::filesystem::is_regular_file(output, ignored))
            there.emplace(number_of(output), output);
    if (there.empty()) return {};
    const std::scoped_lock lock(mutex_);
    for (const std::string& path : paths_)
        if (const auto output = there.find(number_of(path)); output != there.end())
            if (auto safe = check_output(output->second, {path}); !safe) return safe;
    return {};
}

core::Result<void> write_output(const std::string& path, const std::string& text,
                                const ReadFiles& read) {
    if (auto safe = read.check(path); !safe) return safe;
    return write_output(path, text);
}

} // namespace app

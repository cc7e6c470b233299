#include "app/commands/read_files.h"

#include <filesystem>

#include "app/commands/output.h"

namespace app {

ReadFiles::ReadFiles() : listening_([this](const core::FileLook& look) { note(look); }) {}

void ReadFiles::note(const core::FileLook& look) {
    if (look.question == core::FileQuestion::content) add(look.path);
}

void ReadFiles::add(const std::string& path) {
    const std::scoped_lock lock(mutex_);
    paths_.insert(path);
}

core::Result<void> ReadFiles::check(const std::string& output) const {
    std::error_code ignored;
    if (output.empty() || !std::filesystem::is_regular_file(output, ignored)) return {};
    const std::scoped_lock lock(mutex_);
    for (const std::string& path : paths_)
        if (auto safe = check_output(output, {path}); !safe) return safe;
    return {};
}

core::Result<void> write_output(const std::string& path, const std::string& text,
                                const ReadFiles& read) {
    if (auto safe = read.check(path); !safe) return safe;
    return write_output(path, text);
}

} // namespace app

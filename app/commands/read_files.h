#pragma once

#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "core/base/file_reads.h"
#include "core/base/result.h"

namespace app {

/// The files that a command has read, so that it does not overwrite them: programs, subprograms,
/// set-ups, and the meshes, machines and tables named in set-ups.
class ReadFiles {
public:
    /// Records all files that this thread reads from now on.
    ReadFiles();

    /// Records an access by another thread.
    void note(const core::FileAccess& access);
    void add(const std::string& path); // an empty path is ignored

    /// Refuses an output file that was read, also under another name or link.
    ///
    /// Errors: invalid_value, with the path.
    core::Result<void> check(const std::string& output) const;
    core::Result<void> check(const std::vector<std::string>& outputs) const;

private:
    mutable std::mutex mutex_;
    std::set<std::string> paths_;
    core::FileAccessObserver listening_;
};

/// As write_output, but refuses to overwrite a file that was read.
core::Result<void> write_output(const std::string& path, const std::string& text,
                                const ReadFiles& read);

} // namespace app

#pragma once

#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "core/base/file_reads.h"
#include "core/base/result.h"

namespace app {

/// The files that a command has read, so that nothing it writes takes the place of one of them:
/// programs and subprograms, set-ups and the meshes, machines and tables that they name.
class ReadFiles {
public:
    /// From here on this thread's reads count.
    ReadFiles();

    /// Told of a look by another thread.
    void note(const core::FileAccess& look);
    void add(const std::string& path); // empty: nothing

    /// Refuses an output file that is one of them, also by another name or link.
    ///
    /// Errors: invalid_value, with the path.
    core::Result<void> check(const std::string& output) const;
    core::Result<void> check(const std::vector<std::string>& outputs) const;

private:
    mutable std::mutex mutex_;
    std::set<std::string> paths_;
    core::FileAccessObserver listening_;
};

/// As write_output, of what is not to take the place of a file that was read.
core::Result<void> write_output(const std::string& path, const std::string& text,
                                const ReadFiles& read);

} // namespace app

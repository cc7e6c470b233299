#pragma once

#include <cstdint>
#include <string>

namespace app {

/// What tells, without reading, whether a file or folder was written since.
struct FileStamp {
    bool is_there = false;
    bool is_folder = false;
    bool is_file = false; // that has bytes to be read
    uint64_t device = 0, number = 0, size = 0;
    int64_t modified = 0, changed = 0; // nanoseconds since 1970

    bool operator==(const FileStamp&) const = default;
};

/// That of what a path leads to.
FileStamp stamp_of(const std::string& path);

/// Whether it was written so short a time ago that it may have been written again without another
/// time: what was read just now may be older than the stamp.
bool is_fresh(const FileStamp& stamp);

} // namespace app

#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
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

/// How long after it was written a file may be written again without another time.
std::chrono::nanoseconds tick_of(const FileStamp& stamp);

/// Whether it was written so short a time ago that it may have been written again without another
/// time: what was read just now may be older than the stamp. Always of a time to come, as a clock
/// that is ahead gives it: when that was nobody knows.
bool may_change_unseen(const FileStamp& stamp);

/// Where a file is, or will be once it is written: whole, behind all links. Empty where nobody can
/// know, as behind a loop of links.
std::filesystem::path place_of(const std::filesystem::path& path);

/// Tells whether two paths are the same file by its name, however its folder is spelled.
class FileIdentities {
public:
    /// The same for `ok/a.nc`, `ok/../ok/a.nc` and `/lib/ok/a.nc`. Links to folders are followed; a
    /// link to a file is a file of its own, as another set-up may stand beside it.
    std::string of(const std::filesystem::path& path);

private:
    std::map<std::string, std::filesystem::path> folders_; // whole, by how they were spelled
};

/// A path without the parts that lead nowhere: `./a//b` is `a/b`. Unlike lexically_normal it leaves
/// `..`, as `link/..` is not the folder of the link.
std::string plain_path(const std::filesystem::path& path);

} // namespace app

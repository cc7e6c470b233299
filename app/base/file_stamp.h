#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace app {

/// Metadata of a file or folder that shows, without reading it, whether it was written since.
struct FileStamp {
    bool is_there = false;
    bool is_folder = false;
    bool is_file = false; // a regular file
    uint64_t device = 0, number = 0, size = 0;
    int64_t modified = 0, changed = 0; // nanoseconds since 1970

    bool operator==(const FileStamp&) const = default;
};

/// The stamp of the target of a path; links are followed.
FileStamp stamp_of(const std::string& path);

/// How long after a write another write may leave the time stamp unchanged.
std::chrono::nanoseconds tick_of(const FileStamp& stamp);

/// Whether the file was written so recently that another write may have left its time stamp
/// unchanged, so its content may be newer than what was read. Always true for a time in the future,
/// as from a clock that is ahead, because the true time of writing is unknown.
bool may_change_unseen(const FileStamp& stamp, std::chrono::system_clock::time_point now =
                                                   std::chrono::system_clock::now());

/// The absolute path without links, as far as the file or its folders exist, written with slashes
/// on every system and in the case of the file system. The path itself on failure.
std::filesystem::path whole_path(const std::filesystem::path& path, std::error_code& failure);

/// The absolute path of a file that exists or will be written, with all links resolved. Empty if it
/// cannot be determined, as for a loop of links.
std::filesystem::path resolved_path(const std::filesystem::path& path);

/// Identifies files by name, regardless of how their folder is written.
class FileIdentities {
public:
    /// Equal for `ok/a.nc`, `ok/../ok/a.nc` and `/lib/ok/a.nc`. Links to folders are followed; a
    /// link to a file counts as a separate file, because it may be next to another set-up.
    std::string of(const std::filesystem::path& path);

private:
    std::map<std::string, std::filesystem::path> folders_; // absolute paths, by path as given
};

/// A path without redundant parts: `./a//b` becomes `a/b`. Unlike lexically_normal it keeps `..`,
/// because `link/..` is not the folder of the link.
std::string plain_path(const std::filesystem::path& path);

} // namespace app

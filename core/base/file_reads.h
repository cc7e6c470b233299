#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace core {

/// The kinds of file access.
enum class FileAccessKind : uint8_t {
    content,   // the bytes of a file; no answer if it cannot be read to its end
    presence,  // the result of presence_of; no answer if nothing exists under the path
    in_folder, // where a name in a folder leads to; no answer if the folder has no such file
    any_case,  // the name of a file that matches when case is ignored; no answer if none does
    listing,   // all names in a folder; the answer is not reported
    kind,      // whether a file looks like a program; the answer is not reported
};

/// One access to the disk and its answer.
struct FileAccess {
    FileAccessKind question{};
    std::string path; // of the file, or of the folder that holds the name
    std::string name{};
    std::optional<std::string_view> answer{};
};

/// Reports every file access of this thread to a callback while the object exists. A check collects
/// its inputs this way: all code reads files through the functions below.
class FileAccessObserver {
public:
    using Callback = std::function<void(const FileAccess&)>;

    explicit FileAccessObserver(Callback callback);
    ~FileAccessObserver();
    FileAccessObserver(const FileAccessObserver&) = delete;
    FileAccessObserver& operator=(const FileAccessObserver&) = delete;

private:
    Callback callback_;
    const FileAccessObserver* older_;

    friend void notify_file_access(const FileAccess& access);
};

/// Reports an access to the observer of this thread, if there is one. Leaves errno unchanged.
void notify_file_access(const FileAccess& access);

/// The bytes of a file; empty if it cannot be read, with the reason in errno. Of a file longer than
/// `limit`, the first `limit` + 1 bytes. Pipes and devices are not read, as they may never end.
std::optional<std::string> file_bytes(const std::filesystem::path& path,
                                      size_t limit = std::numeric_limits<size_t>::max() - 1);

/// What exists under a path: "file" (readable bytes), "folder", "link" (dangling), "other" (pipe or
/// device), "unknown" (the system cannot tell); empty if nothing exists.
std::optional<std::string_view> presence_of(const std::filesystem::path& path);

/// Why the path cannot be read as a file, such as "is a folder, not a file"; empty for a file.
std::string why_no_file(const std::filesystem::path& path);

/// Whether anything exists under the path, dangling links included.
bool is_there(const std::filesystem::path& path);

/// Whether the path is a folder.
bool is_folder(const std::filesystem::path& path);

/// Whether the path is a file with readable bytes.
bool is_file(const std::filesystem::path& path);

} // namespace core

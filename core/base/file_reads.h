#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace core {

/// What a reader asks the disk.
enum class FileQuestion : uint8_t {
    content,   // of the file: its bytes; no answer when it cannot be read, or not to its end
    presence,  // as presence_of says it; no answer when there is nothing
    in_folder, // where a file of that name leads to; no answer when there is none in the folder
    any_case,  // the name of a file that is called so in any case; no answer when there is none
    listing,   // of a folder, all names in it; the answer is not told
    kind,      // of a file, whether it looks like a program; likewise
};

/// A question to the disk and what it answered.
struct FileAccess {
    FileQuestion question{};
    std::string path; // of the file, or of the folder that is asked about a name
    std::string name{};
    std::optional<std::string_view> answer{};
};

/// While it lives, somebody is told of every look that readers of this thread take at the disk. It
/// is how a check knows its inputs: all of the stack asks by the functions below.
class FileAccessObserver {
public:
    using Told = std::function<void(const FileAccess&)>;

    explicit FileAccessObserver(Told told);
    ~FileAccessObserver();
    FileAccessObserver(const FileAccessObserver&) = delete;
    FileAccessObserver& operator=(const FileAccessObserver&) = delete;

private:
    Told told_;
    const FileAccessObserver* older_;

    friend void notify_file_access(const FileAccess& look);
};

/// Tells who listens on this thread, if anybody does. errno stays what it was.
void notify_file_access(const FileAccess& look);

/// The bytes of a file; empty when it cannot be read, with the reason in errno. Of a file that is
/// longer than `limit` one byte more than that is read. Pipes and devices, which may never end, are
/// not read.
std::optional<std::string> file_bytes(const std::filesystem::path& path,
                                      size_t limit = std::numeric_limits<size_t>::max() - 1);

/// What there is of this name: "file" that has bytes to be read, "folder", "link" that leads
/// nowhere, "other" for a pipe or a device, "unknown" when the disk does not say, or nothing.
std::optional<std::string_view> presence_of(const std::filesystem::path& path);

/// Why no bytes can be read by this name: "is a folder, not a file"; empty for a file.
std::string why_no_file(const std::filesystem::path& path);

/// Whether there is anything of this name, be it a link that leads nowhere.
bool is_there(const std::filesystem::path& path);

/// Whether there is a folder of this name.
bool is_folder(const std::filesystem::path& path);

/// Whether there is a file of this name that has bytes to be read.
bool is_file(const std::filesystem::path& path);

} // namespace core

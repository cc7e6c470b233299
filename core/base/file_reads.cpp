#include "core/base/file_reads.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <utility>

#include "core/base/platform.h"

namespace core {
namespace {

thread_local const FileAccessObserver* youngest = nullptr;

std::optional<std::string> read_bytes(const std::filesystem::path& path, size_t limit) {
    std::error_code failure;
    const std::filesystem::file_status status = std::filesystem::status(path, failure);
    const bool is_other =
        std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
    if (is_other || platform::is_device(path)) {
        errno = std::filesystem::is_directory(status) ? EISDIR : ENOTSUP;
        return std::nullopt;
    }
    errno = 0;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(platform::open_file(path, "rb"),
                                                               std::fclose);
    if (!file) return std::nullopt;
    std::string bytes;
    std::array<char, 65536> chunk;
    size_t count = 0;
    do {
        const size_t wanted = std::min(chunk.size(), limit + 1 - bytes.size());
        count = std::fread(chunk.data(), 1, wanted, file.get());
        bytes.append(chunk.data(), count);
    } while (count > 0 && bytes.size() <= limit);
    if (std::ferror(file.get()) != 0) return std::nullopt;
    return bytes;
}

/// What exists under a path whose target cannot be determined.
std::optional<std::string_view> leftover_of(const std::filesystem::path& path,
                                            const std::error_code& failure) {
    std::error_code ignored;
    const bool is_absent = failure == std::errc::no_such_file_or_directory
                           || failure == std::errc::not_a_directory
                           || failure == std::errc::filename_too_long;
    const bool leads_nowhere = is_absent || failure == std::errc::too_many_symbolic_link_levels;
    if (leads_nowhere
        && std::filesystem::is_symlink(std::filesystem::symlink_status(path, ignored)))
        return "link";
    return is_absent ? std::nullopt : std::optional<std::string_view>("unknown");
}

} // namespace

FileAccessObserver::FileAccessObserver(Callback callback)
    : callback_(std::move(callback)), older_(youngest) {
    youngest = this;
}

FileAccessObserver::~FileAccessObserver() { youngest = older_; }

void notify_file_access(const FileAccess& access) {
    if (!youngest) return;
    const int reason = errno;
    for (const FileAccessObserver* each = youngest; each; each = each->older_)
        each->callback_(access);
    errno = reason;
}

std::optional<std::string> file_bytes(const std::filesystem::path& path, size_t limit) {
    std::optional<std::string> bytes = read_bytes(path, limit);
    const bool is_whole = bytes && bytes->size() <= limit;
    notify_file_access({FileAccessKind::content,
                        path.generic_string(),
                        {},
                        is_whole ? std::optional<std::string_view>(*bytes) : std::nullopt});
    return bytes;
}

std::optional<std::string_view> presence_of(const std::filesystem::path& path) {
    std::error_code failure;
    const std::filesystem::file_status status = std::filesystem::status(path, failure);
    std::optional<std::string_view> answer;
    if (platform::is_device(path))
        answer = "other";
    else if (std::filesystem::is_regular_file(status))
        answer = "file";
    else if (std::filesystem::is_directory(status))
        answer = "folder";
    else if (std::filesystem::exists(status))
        answer = "other";
    else
        answer = leftover_of(path, failure);
    notify_file_access({FileAccessKind::presence, path.generic_string(), {}, answer});
    return answer;
}

std::string why_no_file(const std::filesystem::path& path) {
    const auto found = presence_of(path);
    if (!found) return "there is no such file";
    if (*found == "folder") return "is a folder, not a file";
    if (*found == "link") return "is a link that leads nowhere";
    if (*found == "other") return "is a pipe or a device, not a file";
    return *found == "file" ? "" : "cannot be accessed";
}

bool is_there(const std::filesystem::path& path) { return presence_of(path).has_value(); }

bool is_folder(const std::filesystem::path& path) { return presence_of(path) == "folder"; }

bool is_file(const std::filesystem::path& path) { return presence_of(path) == "file"; }

} // namespace core

#include "core/base/file_reads.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <utility>

namespace core {
namespace {

thread_local const FileListening* youngest = nullptr;

std::optional<std::string> read_bytes(const std::filesystem::path& path, size_t limit) {
    errno = 0;
    std::ifstream stream(path, std::ios::binary);
    if (!stream) return std::nullopt;
    std::string bytes;
    std::array<char, 65536> chunk;
    while (stream && bytes.size() <= limit) {
        const size_t wanted = std::min(chunk.size(), limit + 1 - bytes.size());
        stream.read(chunk.data(), static_cast<std::streamsize>(wanted));
        bytes.append(chunk.data(), static_cast<size_t>(stream.gcount()));
    }
    if (stream.bad()) return std::nullopt;
    return bytes;
}

} // namespace

FileListening::FileListening(Told told) : told_(std::move(told)), older_(youngest) {
    youngest = this;
}

FileListening::~FileListening() { youngest = older_; }

void note_look(const FileLook& look) {
    if (!youngest) return;
    const int reason = errno;
    for (const FileListening* each = youngest; each; each = each->older_) each->told_(look);
    errno = reason;
}

std::optional<std::string> file_bytes(const std::filesystem::path& path, size_t limit) {
    std::optional<std::string> bytes = read_bytes(path, limit);
    const bool is_whole = bytes && bytes->size() <= limit;
    note_look({FileQuestion::content,
               path.string(),
               {},
               is_whole ? std::optional<std::string_view>(*bytes) : std::nullopt});
    return bytes;
}

std::optional<std::string_view> presence_of(const std::filesystem::path& path) {
    std::error_code failure;
    const std::filesystem::file_status status = std::filesystem::status(path, failure);
    std::optional<std::string_view> answer;
    if (std::filesystem::is_regular_file(status))
        answer = "file";
    else if (std::filesystem::is_directory(status))
        answer = "folder";
    else if (std::filesystem::exists(status))
        answer = "other";
    note_look({FileQuestion::presence, path.string(), {}, answer});
    return answer;
}

bool is_there(const std::filesystem::path& path) { return presence_of(path).has_value(); }

bool is_folder(const std::filesystem::path& path) { return presence_of(path) == "folder"; }

bool is_file(const std::filesystem::path& path) { return presence_of(path) == "file"; }

} // namespace core

#include "app/base/file_stamp.h"

#include <algorithm>

#include "core/base/platform.h"

namespace app {
namespace {

using namespace std::chrono_literals;

/// The later of both times: a file that is moved over another keeps its modification time.
std::chrono::nanoseconds last_change(const FileStamp& stamp) {
    return std::chrono::nanoseconds(std::max(stamp.modified, stamp.changed));
}

} // namespace

FileStamp stamp_of(const std::string& path) {
    const auto facts = core::platform::facts_of(path);
    if (!facts) return {};
    return {.is_there = true,
            .is_folder = facts->is_folder,
            .is_file = facts->is_file,
            .device = facts->device,
            .number = facts->number,
            .size = facts->size,
            .modified = facts->modified,
            .changed = facts->changed};
}

std::chrono::nanoseconds tick_of(const FileStamp& stamp) {
    // Margin for the time between reading a file and its stamp; file times have ticks of a few ms.
    const bool has_whole_seconds = last_change(stamp) % 1s == 0ns; // or steps of 2 s, as on FAT
    return has_whole_seconds ? 2500ms : 50ms;
}

bool may_change_unseen(const FileStamp& stamp, std::chrono::system_clock::time_point now) {
    return stamp.is_there && last_change(stamp) > now.time_since_epoch() - tick_of(stamp);
}

std::filesystem::path whole_path(const std::filesystem::path& path, std::error_code& failure) {
    const std::filesystem::path whole =
        std::filesystem::weakly_canonical(std::filesystem::absolute(path, failure), failure);
    if (failure) return path;
    return core::platform::with_slashes(core::platform::in_stored_case(whole).string());
}

std::filesystem::path resolved_path(const std::filesystem::path& path) {
    constexpr int most_links = 40; // limit of the system
    std::error_code ignored;
    std::filesystem::path target = std::filesystem::absolute(path, ignored);
    for (int i = 0; i < most_links && std::filesystem::is_symlink(target, ignored); ++i)
        target = target.parent_path() / std::filesystem::read_symlink(target, ignored);
    std::error_code failure;
    const std::filesystem::path whole = whole_path(target, failure);
    return failure ? std::filesystem::path() : whole;
}

std::string FileIdentities::of(const std::filesystem::path& path) {
    const std::filesystem::path plain = plain_path(path);
    const std::string folder = plain.has_parent_path() ? plain.parent_path().generic_string() : ".";
    const auto [known, is_new] = folders_.try_emplace(folder);
    if (is_new) {
        std::error_code failure;
        known->second = whole_path(folder, failure);
    }
    return core::platform::in_stored_case(known->second / plain.filename()).generic_string();
}

std::string plain_path(const std::filesystem::path& path) {
    std::filesystem::path plain;
    for (const std::filesystem::path& part : path)
        if (part != "." && !part.empty()) plain /= part;
    return plain.empty() ? "." : plain.generic_string();
}

} // namespace app

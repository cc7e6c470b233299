#include "app/batch/watched_files.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include <sys/stat.h>

#include "gcode/program_folder.h"

namespace app {
namespace {

namespace fs = std::filesystem;

/// Between reading a file and looking at its time; the clock of files has ticks of some ms.
constexpr int64_t fresh = 50'000'000; // ns

int64_t nanoseconds(const timespec& time) {
    return int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

int64_t now() {
    using namespace std::chrono;
    return duration_cast<std::chrono::nanoseconds>(system_clock::now().time_since_epoch()).count();
}

std::string whole_path(const std::string& path) {
    std::error_code failure;
    const fs::path whole = fs::weakly_canonical(fs::absolute(path, failure), failure);
    return failure ? path : whole.string();
}

} // namespace

WatchedFiles::WatchedFiles(const std::vector<std::string>& own) {
    for (const std::string& path : own)
        if (!path.empty()) own_.push_back(whole_path(path));
}

bool WatchedFiles::is_own(const std::string& path) const {
    if (own_.empty()) return false;
    const std::string whole = whole_path(path);
    // A database has a journal beside it, of its name and some more.
    return std::any_of(own_.begin(), own_.end(), [&](const std::string& own) {
        return whole == own || whole.starts_with(own + "-");
    });
}

std::string WatchedFiles::names_of(const std::string& folder) const {
    std::string names;
    for (const std::string& name : gcode::names_in(folder))
        if (name[0] != '.' && !is_own((fs::path(folder) / name).string())) names += name + '\n';
    return names;
}

WatchedFiles::Stamp WatchedFiles::stamp_of(const std::string& path, const Place& place) const {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return {};
    Stamp stamp{.is_there = true,
                .device = static_cast<uint64_t>(status.st_dev),
                .number = static_cast<uint64_t>(status.st_ino),
                .size = static_cast<uint64_t>(status.st_size),
                .modified = nanoseconds(status.st_mtim),
                .changed = nanoseconds(status.st_ctim)};
    if (!S_ISDIR(status.st_mode)) return stamp;
    // Of a folder only the names count: also what does not concern anybody changes its times.
    const bool is_untouched = place.latest.is_there && stamp.modified == place.latest.modified
                              && stamp.number == place.latest.number;
    if (place.is_folder) stamp.names = is_untouched ? place.latest.names : names_of(path);
    stamp.size = 0;
    stamp.changed = 0;
    return stamp;
}

void WatchedFiles::note(const core::FileLook& look) {
    const bool is_listed = look.question == core::FileQuestion::listing
                           || look.question == core::FileQuestion::any_case;
    const bool is_named = look.question == core::FileQuestion::in_folder;
    const std::string path = is_named ? (fs::path(look.path) / look.name).string() : look.path;
    if (path.empty() || is_own(path)) return;
    const std::lock_guard lock(mutex_);
    const auto [found, is_new] = places_.try_emplace(path);
    Place& place = found->second;
    if (!is_new && (place.is_folder || !is_listed)) return;
    place.is_folder = is_listed;
    place.first = place.latest = {};
    place.first = place.latest = stamp_of(path, place);
    place.was_fresh = !is_listed && place.first.is_there && place.first.modified > now() - fresh;
}

WatchedFiles::Change WatchedFiles::look_again() {
    const auto differ = [](Stamp a, Stamp b, bool is_folder) {
        if (is_folder) a.modified = b.modified = 0;
        return a != b;
    };
    Change change;
    for (auto& [path, place] : places_) {
        Stamp stamp = stamp_of(path, place);
        if (differ(stamp, place.latest, place.is_folder)) change.is_settled = false;
        place.latest = std::move(stamp);
        if (place.was_fresh || differ(place.latest, place.first, place.is_folder))
            change.paths.push_back(path);
    }
    return change;
}

} // namespace app

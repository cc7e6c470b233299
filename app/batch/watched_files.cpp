#include "app/batch/watched_files.h"

#include <algorithm>
#include <filesystem>

#include "gcode/program_folder.h"

namespace app {
namespace {

namespace fs = std::filesystem;

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

WatchedFiles::Look WatchedFiles::look_at(const std::string& path, const Place& place) const {
    Look look{stamp_of(path)};
    if (!look.stamp.is_folder) return look;
    // Of a folder only the names count: also what does not concern anybody changes its times.
    const FileStamp& before = place.latest.stamp;
    const bool is_untouched = before.is_there && look.stamp.modified == before.modified
                              && look.stamp.number == before.number;
    if (place.is_folder) look.names = is_untouched ? place.latest.names : names_of(path);
    look.stamp.size = 0;
    look.stamp.changed = 0;
    return look;
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
    place.first = place.latest = look_at(path, place);
    place.was_fresh = !is_listed && is_fresh(place.first.stamp);
}

WatchedFiles::Change WatchedFiles::look_again() {
    const auto differ = [](Look a, Look b, bool is_folder) {
        if (is_folder) a.stamp.modified = b.stamp.modified = 0;
        return a != b;
    };
    Change change;
    for (auto& [path, place] : places_) {
        Look look = look_at(path, place);
        if (differ(look, place.latest, place.is_folder)) change.is_settled = false;
        place.latest = std::move(look);
        if (place.was_fresh || differ(place.latest, place.first, place.is_folder))
            change.paths.push_back(path);
    }
    return change;
}

} // namespace app

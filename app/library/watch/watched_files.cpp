#include "app/library/watch/watched_files.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "app/base/file_stamp.h"
#include "app/library/find/program_finder.h"
#include "gcode/language/program_folder.h"

namespace app {
namespace {

namespace fs = std::filesystem;

/// The file to which a path leads; a broken link is its own target.
std::string target_of(const std::string& path) {
    std::error_code failure;
    return whole_path(path, failure).generic_string();
}

/// The path of a file as it is, or will be once it is written.
std::string written_path(const std::string& path) {
    const fs::path resolved = resolved_path(path);
    return resolved.empty() ? path : resolved.generic_string();
}

/// Why a file is not a program, see why_no_program; empty for a program, "?" if unreadable.
std::string kind_of(const std::string& path) {
    const auto why = why_no_program(path);
    if (!why) return "?";
    return why->value_or("");
}

/// The paths without duplicates: of several that lead to the same file, the first.
std::vector<std::string> each_once(const std::vector<std::string>& paths) {
    std::vector<std::string> once;
    std::set<std::string> seen;
    for (const std::string& path : paths)
        if (seen.insert(target_of(path)).second) once.push_back(path);
    return once;
}

} // namespace

WatchTime WatchTime::now() {
    return {std::chrono::system_clock::now(), std::chrono::steady_clock::now()};
}

WatchedFiles::WatchedFiles(const std::vector<std::string>& own, std::function<WatchTime()> clock)
    : clock_(std::move(clock)) {
    for (const std::string& path : own) add_own(path);
}

void WatchedFiles::add_own(const std::string& path) {
    if (path.empty()) return;
    own_.insert(written_path(path));
}

bool WatchedFiles::reads(const std::string& path) const {
    const FileStamp file = stamp_of(path);
    return std::any_of(own_reads_.begin(), own_reads_.end(),
                       [&](const std::string& own) { return stamp_of(own) == file; });
}

bool WatchedFiles::is_own(const std::string& path) const {
    if (own_.empty()) return false;
    const std::string whole = written_path(path);
    return std::any_of(own_.begin(), own_.end(), [&](const std::string& own) {
        // SQLite creates these next to a database.
        return whole == own || whole == own + "-journal" || whole == own + "-wal"
               || whole == own + "-shm";
    });
}

std::string WatchedFiles::names_of(const std::string& folder) const {
    std::string names;
    for (const std::string& name : gcode::names_in(folder))
        if (name[0] != '.' && !is_own((fs::path(folder) / name).generic_string()))
            names += name + '\n';
    return names;
}

/// Whether a file may be written again without a new time stamp. A stamp in the future would always
/// count as fresh, so the time since it was first seen decides.
bool WatchedFiles::may_be_rewritten(const std::string& path, const FileStamp& stamp) {
    const WatchTime now = clock_();
    if (!may_change_unseen(stamp, now.of_day)) {
        fresh_.erase(path);
        return false;
    }
    Seen& seen = fresh_.try_emplace(path, Seen{stamp, now.steady}).first->second;
    if (seen.stamp != stamp) seen = {stamp, now.steady};
    return now.steady - seen.since <= tick_of(stamp);
}

WatchedFiles::Observation WatchedFiles::observe(const std::string& path, const Asked& asked,
                                                const Observation& before) {
    Observation observation{stamp_of(path)};
    observation.was_fresh = may_be_rewritten(path, observation.stamp);
    const bool is_known = before.stamp == observation.stamp && !before.was_fresh;
    if (asked.names && observation.stamp.is_folder)
        observation.names = is_known ? before.names : names_of(path);
    if (asked.kind && observation.stamp.is_file) // reading a pipe would block
        observation.kind = is_known ? before.kind : kind_of(path);
    return observation;
}

bool WatchedFiles::differ(const Asked& asked, const Observation& a, const Observation& b) {
    if (a.stamp.is_there != b.stamp.is_there || a.stamp.is_folder != b.stamp.is_folder
        || a.stamp.is_file != b.stamp.is_file)
        return true;
    // For a folder only the names matter: its times also change for irrelevant reasons. But a link
    // may now lead to another folder.
    if (a.stamp.is_folder && (a.stamp.number != b.stamp.number || a.stamp.device != b.stamp.device))
        return true;
    if (asked.bytes && !a.stamp.is_folder && a.stamp != b.stamp) return true;
    return a.names != b.names || a.kind != b.kind;
}

void WatchedFiles::note(const core::FileAccess& access) {
    using enum core::FileAccessKind;
    const bool is_named = access.question == in_folder;
    const std::string path =
        is_named ? (fs::path(access.path) / access.name).generic_string() : access.path;
    if (path.empty()) return;
    const std::lock_guard lock(mutex_);
    if (is_own(path)) {
        if (access.question == content || is_named) own_reads_.insert(path);
        return;
    }
    const auto [found, is_new] = paths_.try_emplace(path);
    WatchedPath& watched = found->second;
    const Asked before = watched.asked;
    watched.asked.bytes |= access.question == content || is_named;
    watched.asked.names |= access.question == listing || access.question == any_case;
    watched.asked.kind |= access.question == kind;
    if (!is_new && watched.asked == before) return;
    watched.latest = observe(path, watched.asked, {});
    watched.first = watched.latest;
}

WatchedFiles::Change WatchedFiles::poll() {
    Change change;
    for (auto& [path, watched] : paths_) {
        Observation observation = observe(path, watched.asked, watched.latest);
        if (differ(watched.asked, observation, watched.latest))
            (watched.asked.names ? change.are_names_settled : change.are_files_settled) = false;
        watched.latest = std::move(observation);
        const bool was_written = watched.asked.bytes && watched.first.was_fresh;
        const bool differs = differ(watched.asked, watched.latest, watched.first);
        if (was_written || differs) change.paths.push_back(path);
        if (was_written && !differs && watched.latest.was_fresh) change.are_files_settled = false;
    }
    change.paths = each_once(change.paths);
    return change;
}

using namespace std::chrono_literals;

bool WatchPace::is_time(const WatchedFiles::Change& change, Clock::time_point begin,
                        Clock::duration took) {
    constexpr int pause_ratio = 20; // ratio of the pause to the duration of polling
    pause_ = std::max(least_pause, pause_ratio * took);
    if (change.paths.empty()) {
        since_ = begin + took;
        return false;
    }
    const Clock::duration waited = begin - since_;
    const bool are_names_settled = change.are_names_settled || waited > 2s;
    return (change.are_files_settled && are_names_settled) || waited > 30s;
}

} // namespace app

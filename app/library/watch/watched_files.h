#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "app/base/file_stamp.h"
#include "core/base/file_reads.h"

namespace app {

/// A moment by both clocks: time stamps of files follow the time of day, which may be set.
struct WatchTime {
    std::chrono::system_clock::time_point of_day;
    std::chrono::steady_clock::time_point steady;

    static WatchTime now();
};

/// The paths that a check has accessed, each with its state at the first access. In listed folders,
/// names that begin with a dot are ignored.
class WatchedFiles {
public:
    /// `own`: files that the check itself writes; they do not count as changes. `clock`: called by
    /// each access to a path.
    explicit WatchedFiles(const std::vector<std::string>& own = {},
                          std::function<WatchTime()> clock = WatchTime::now);

    /// Adds a file to `own`.
    void add_own(const std::string& path);

    /// Records an access; call it when the access is made. Thread-safe.
    void note(const core::FileAccess& access);

    size_t size() const { return paths_.size(); }

    /// Whether the check has read this one of its own files, by any path.
    bool reads(const std::string& path) const;

    /// Drops all paths before another check.
    void begin_again() {
        paths_.clear();
        own_reads_.clear();
    }

    struct Change {
        std::vector<std::string> paths; // changed paths, sorted; each file once
        // Whether no file, and no name in a folder, has changed since the previous call.
        bool are_files_settled = true, are_names_settled = true;
    };

    /// Compares all paths with their recorded state. A file that was written when it was read
    /// counts as changed, once per time stamp, because the old or the new content may have been
    /// read. It has settled once another write would change its time stamp.
    ///
    /// Cost: one stat per path, and a new read of changed files and folders.
    Change poll();

private:
    /// What the check accessed, besides the type of the path, which is always compared.
    struct Asked {
        bool bytes = false;
        bool names = false; // the names in a folder
        bool kind = false;  // whether the file looks like a program

        bool operator==(const Asked&) const = default;
    };
    struct Observation {
        FileStamp stamp;
        bool was_fresh = false; // may have been written when it was examined
        std::string names = {}, kind = {};
    };
    struct WatchedPath {
        Asked asked;
        Observation first, latest;
    };
    struct Seen {
        FileStamp stamp;
        std::chrono::steady_clock::time_point since{};
    };

    Observation observe(const std::string& path, const Asked& asked, const Observation& before);
    bool may_be_rewritten(const std::string& path, const FileStamp& stamp);
    bool is_own(const std::string& path) const;
    std::string names_of(const std::string& folder) const;
    static bool differ(const Asked& asked, const Observation& a, const Observation& b);

    std::function<WatchTime()> clock_;
    std::set<std::string> own_, own_reads_;
    std::map<std::string, WatchedPath> paths_; // by path
    std::map<std::string, Seen> fresh_;        // by path; also of earlier checks
    std::mutex mutex_;
};

/// Decides when a watch polls the disk again and when it checks the changes.
class WatchPace {
public:
    using Clock = std::chrono::steady_clock;

    /// `now`: the time up to which nothing has changed.
    explicit WatchPace(Clock::time_point now) : since_(now) {}

    /// Whether to check the changes now: as soon as the files have settled. `begin` and `took` are
    /// the start and duration of the last poll. Waits at most 2 s for names that keep changing, and
    /// 30 s for files that are still being written.
    bool is_time(const WatchedFiles::Change& change, Clock::time_point begin, Clock::duration took);

    /// The time until the next poll. Polling takes at most a twentieth of the time, however many
    /// files there are.
    Clock::duration pause() const { return pause_; }

private:
    static constexpr Clock::duration least_pause = std::chrono::milliseconds(200);

    Clock::duration pause_ = least_pause;
    Clock::time_point since_; // time up to which nothing had changed
};

} // namespace app

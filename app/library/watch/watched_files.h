#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "app/base/file_stamp.h"
#include "core/base/file_reads.h"

namespace app {

/// The paths that a check accessed, each with its state at the first access. Names that begin with
/// a dot are ignored in listed folders.
class WatchedFiles {
public:
    /// `own`: files that the check writes itself; they do not count as changes.
    explicit WatchedFiles(const std::vector<std::string>& own = {});

    /// Adds a file to `own`.
    void add_own(const std::string& path);

    /// Records an access when it is made. Thread-safe.
    void note(const core::FileAccess& look);

    size_t size() const { return places_.size(); }

    /// Whether the check read this file of its own, under any name.
    bool reads(const std::string& path) const;

    /// Forgets all paths, for another check.
    void begin_again() {
        places_.clear();
        own_reads_.clear();
    }

    struct Change {
        std::vector<std::string> paths; // that changed, sorted; each file once
        // Nothing changed since the previous call: no file, no name in a folder.
        bool are_files_settled = true, are_names_settled = true;
    };

    /// Compares all paths with their recorded state. A file written at the moment it was read
    /// counts as changed, once per time stamp, since either content may have been read. It has
    /// settled once another write would change its time stamp. Cost: one stat per path, and a new
    /// read of changed files and folders.
    Change look_again();

private:
    /// What was asked for, besides the type of the path, which is always compared.
    struct Asked {
        bool bytes = false;
        bool names = false; // in a folder
        bool kind = false;  // whether it looks like a program

        bool operator==(const Asked&) const = default;
    };
    struct Look {
        FileStamp stamp;
        bool was_fresh = false; // written just when it was looked at
        std::string names = {}, kind = {};
    };
    struct Place {
        Asked asked;
        Look first, latest;
    };
    struct Seen {
        FileStamp stamp;
        std::chrono::steady_clock::time_point since{};
    };

    Look look_at(const std::string& path, const Asked& asked, const Look& before);
    bool may_be_rewritten(const std::string& path, const FileStamp& stamp);
    bool is_own(const std::string& path) const;
    std::string names_of(const std::string& folder) const;
    static bool differ(const Asked& asked, const Look& a, const Look& b);

    std::set<std::string> own_, own_reads_;
    std::map<std::string, Place> places_; // by path
    std::map<std::string, Seen> fresh_;   // likewise; of earlier checks, too
    std::mutex mutex_;
};

/// Decides when a watch looks at the disk again and when it checks what changed.
class WatchPace {
public:
    using Clock = std::chrono::steady_clock;

    /// `now`: the time up to which nothing has changed.
    explicit WatchPace(Clock::time_point now) : since_(now) {}

    /// Whether to check the changes now, given a look that began at `begin` and took `took`: as
    /// soon as the files have settled. Does not wait for names that keep changing or for a file
    /// that is written for a long time.
    bool is_time(const WatchedFiles::Change& change, Clock::time_point begin, Clock::duration took);

    /// The time until the next look. Looking takes at most a twentieth of the time, however many
    /// files there are.
    Clock::duration pause() const { return pause_; }

private:
    static constexpr Clock::duration least_pause = std::chrono::milliseconds(200);

    Clock::duration pause_ = least_pause;
    Clock::time_point since_; // nothing had changed
};

} // namespace app

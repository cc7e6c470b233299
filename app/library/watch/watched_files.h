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

/// The places on disk that a check looked at, each as it was at the first look. What begins with a
/// dot in a folder that was listed does not count.
class WatchedFiles {
public:
    /// `own`: what the check itself writes; that changes nothing.
    explicit WatchedFiles(const std::vector<std::string>& own = {});

    /// As `own`, known later.
    void add_own(const std::string& path);

    /// Told of a look as it is taken. Several threads may tell.
    void note(const core::FileAccess& look);

    size_t size() const { return places_.size(); }

    /// Whether what is in this file of the check's own was asked for, by whatever name.
    bool reads(const std::string& path) const;

    /// Forgets the places, for another check.
    void begin_again() {
        places_.clear();
        own_reads_.clear();
    }

    struct Change {
        std::vector<std::string> paths; // that are not as they were, sorted; each file once
        // Nothing has moved since the call before: no file, no name in a folder.
        bool are_files_settled = true, are_names_settled = true;
    };

    /// How the places are now. One that was written just when it was read counts as changed, once
    /// for each time that it has: nobody knows which of its contents was seen. It has settled when
    /// it could not be written again without another time. Costs a look at the disk for each, and
    /// what was asked for again of folders and files that were written.
    Change look_again();

private:
    /// What was asked for; whether there is a file, a folder or else of its name is always.
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

/// When a watch looks at the disk again, and when it checks what has changed.
class WatchPace {
public:
    using Clock = std::chrono::steady_clock;

    /// Nothing has changed up to now.
    explicit WatchPace(Clock::time_point now) : since_(now) {}

    /// Told of a look, when it began and how long it took. Whether what has changed is to be
    /// checked: once whoever writes it has finished. Names that come and go without end, and a file
    /// that is written for long, are not waited for.
    bool is_time(const WatchedFiles::Change& change, Clock::time_point begin, Clock::duration took);

    /// How long to wait before the next look: a twentieth of the time goes into looking at most,
    /// however many files there are.
    Clock::duration pause() const { return pause_; }

private:
    static constexpr Clock::duration least_pause = std::chrono::milliseconds(200);

    Clock::duration pause_ = least_pause;
    Clock::time_point since_; // nothing had changed
};

} // namespace app

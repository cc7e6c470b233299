#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "app/batch/file_stamp.h"
#include "core/base/file_reads.h"

namespace app {

/// The places on disk that a check looked at, each as it was at the first look. What begins with a
/// dot in a folder that was listed does not count.
class WatchedFiles {
public:
    /// `own`: what the check itself writes; that changes nothing.
    explicit WatchedFiles(const std::vector<std::string>& own = {});

    /// Told of a look as it is taken. Several threads may tell.
    void note(const core::FileLook& look);

    size_t size() const { return places_.size(); }

    struct Change {
        std::vector<std::string> paths; // that are not as they were, sorted
        bool is_settled = true;         // nothing has moved since the call before
    };

    /// How the places are now. One that was written just when it was looked at counts as changed:
    /// nobody knows which of its contents was seen. Costs a look at the disk for each, of folders
    /// that have changed a list of their names.
    Change look_again();

private:
    struct Look {
        FileStamp stamp;
        std::string names = {}; // of a folder that was listed

        bool operator==(const Look&) const = default;
    };
    struct Place {
        Look first, latest;
        bool is_folder = false; // whose names were asked for
        bool was_fresh = false; // it was written just when it was looked at
    };

    Look look_at(const std::string& path, const Place& place) const;
    bool is_own(const std::string& path) const;
    std::string names_of(const std::string& folder) const;

    std::vector<std::string> own_;
    std::map<std::string, Place> places_; // by path
    std::mutex mutex_;
};

} // namespace app

#include "app/batch/folder_walk.h"

#include <algorithm>
#include <deque>
#include <set>

#include <sys/stat.h>

#include "core/base/file_reads.h"

namespace app {
namespace {

namespace fs = std::filesystem;

/// That what has no other look is what it is: it may become a file or another folder, by a link.
void note_presence(const fs::path& path) {
    core::note_look({core::FileQuestion::presence, path.string(), {}, {}});
}

/// Enters folders one after the other, links last.
class Walk {
public:
    explicit Walk(const fs::path& folder) {
        if (is_new(folder)) real_.push_back(folder);
        while (!real_.empty() || !linked_.empty()) {
            std::deque<fs::path>& next = real_.empty() ? linked_ : real_;
            const fs::path entered = next.front();
            next.pop_front();
            // A link was not looked at before: what it leads to may have been entered since.
            if (&next == &linked_ && !is_new(entered)) continue;
            enter(entered);
        }
        std::sort(found.files.begin(), found.files.end());
        std::sort(found.folders.begin(), found.folders.end());
    }

    FolderWalk found;

private:
    bool is_new(const fs::path& folder) {
        struct stat status {};
        return ::stat(folder.c_str(), &status) != 0
               || seen_.insert({status.st_dev, status.st_ino}).second;
    }

    void enter(const fs::path& folder) {
        found.folders.push_back(folder);
        core::note_look({core::FileQuestion::listing, folder.string(), {}, {}});
        std::error_code failure;
        std::vector<fs::directory_entry> entries;
        for (fs::directory_iterator at(folder, failure), end; !failure && at != end;
             at.increment(failure))
            if (at->path().filename().string().front() != '.') entries.push_back(*at);
        // By which of two links a folder is entered must not depend on the disk's own order.
        std::sort(entries.begin(), entries.end());
        for (const fs::directory_entry& entry : entries) sort_in(entry);
        if (failure) found.unreadable.push_back(unreadable_folder(folder, failure));
    }

    void sort_in(const fs::directory_entry& entry) {
        std::error_code failure;
        if (!entry.is_directory(failure))
            found.sort_in(entry.path());
        else if (entry.is_symlink(failure)) {
            note_presence(entry.path());
            linked_.push_back(entry.path());
        } else if (is_new(entry.path()))
            real_.push_back(entry.path());
    }

    std::deque<fs::path> real_, linked_;
    std::set<std::pair<dev_t, ino_t>> seen_;
};

} // namespace

void FolderWalk::sort_in(const fs::path& path) {
    std::error_code failure, ignored;
    const fs::file_status status = fs::status(path, failure);
    if (!fs::is_regular_file(status)) note_presence(path);
    const auto cannot = [&] {
        unreadable.push_back(
            {core::ErrorCode::io, {}, "cannot be looked at: " + failure.message(), path.string()});
    };
    const bool leads_nowhere = status.type() == fs::file_type::not_found
                               || failure == std::errc::too_many_symbolic_link_levels;
    if (failure && !leads_nowhere)
        cannot();
    else if (fs::is_regular_file(status))
        files.push_back(path.string());
    else if (fs::exists(status))
        skipped.push_back({path.string(), "is neither a file nor a folder"});
    else if (fs::is_symlink(fs::symlink_status(path, ignored)))
        skipped.push_back({path.string(), "is a link that leads nowhere"});
    else if (failure != std::errc::no_such_file_or_directory) // that went while it was listed
        cannot();
}

core::Error unreadable_folder(const fs::path& folder, const std::error_code& failure) {
    return {core::ErrorCode::io,
            {},
            "this folder cannot be read: " + failure.message(),
            folder.string()};
}

FolderWalk walk_folder(const std::string& folder) {
    FolderWalk found = Walk(folder).found;
    std::sort(found.skipped.begin(), found.skipped.end(),
              [](const SkippedFile& a, const SkippedFile& b) { return a.path < b.path; });
    return found;
}

} // namespace app

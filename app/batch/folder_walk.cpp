#include "app/batch/folder_walk.h"

#include <algorithm>
#include <deque>
#include <set>

#include <sys/stat.h>

#include "core/base/file_reads.h"

namespace app {
namespace {

namespace fs = std::filesystem;

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
        std::sort(folders.begin(), folders.end());
    }

    FolderWalk found;
    std::vector<fs::path> folders; // all that were entered

private:
    bool is_new(const fs::path& folder) {
        struct stat status {};
        return ::stat(folder.c_str(), &status) != 0
               || seen_.insert({status.st_dev, status.st_ino}).second;
    }

    void enter(const fs::path& folder) {
        folders.push_back(folder);
        core::note_look({core::FileQuestion::listing, folder.string(), {}, {}});
        std::error_code failure;
        for (fs::directory_iterator at(folder, failure), end; !failure && at != end;
             at.increment(failure))
            if (at->path().filename().string().front() != '.') sort_in(*at);
        if (failure)
            found.unreadable.push_back({core::ErrorCode::io,
                                        {},
                                        "this folder cannot be read: " + failure.message(),
                                        folder.string()});
    }

    void sort_in(const fs::directory_entry& entry) {
        std::error_code failure;
        const fs::file_status status = entry.status(failure);
        if (fs::is_directory(status)) {
            if (entry.is_symlink(failure))
                linked_.push_back(entry.path());
            else if (is_new(entry.path()))
                real_.push_back(entry.path());
        } else if (fs::is_regular_file(status)) {
            found.files.push_back(entry.path().string());
        } else {
            const bool is_there = fs::exists(status);
            found.skipped.push_back({entry.path().string(), is_there
                                                                ? "is neither a file nor a folder"
                                                                : "is a link that leads nowhere"});
        }
    }

    std::deque<fs::path> real_, linked_;
    std::set<std::pair<dev_t, ino_t>> seen_;
};

} // namespace

FolderWalk walk_folder(const std::string& folder) {
    FolderWalk found = Walk(folder).found;
    std::sort(found.skipped.begin(), found.skipped.end(),
              [](const SkippedFile& a, const SkippedFile& b) { return a.path < b.path; });
    return found;
}

std::vector<fs::path> folders_below(const fs::path& folder) {
    const fs::path here = folder.empty() ? fs::path(".") : folder;
    std::vector<fs::path> below;
    for (const fs::path& found : Walk(here).folders)
        if (found != here) below.push_back(folder.empty() ? found.lexically_normal() : found);
    return below;
}

} // namespace app

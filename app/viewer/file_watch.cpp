#include "app/viewer/file_watch.h"

namespace app::viewer {

FileWatch::Seen FileWatch::look_at(const std::string& path) {
    Seen seen{path};
    std::error_code gone;
    const auto time = std::filesystem::last_write_time(path, gone);
    if (!gone) seen.time = time;
    const auto size = std::filesystem::file_size(path, gone);
    if (!gone) seen.size = size;
    return seen;
}

void FileWatch::set(std::vector<std::string> paths) {
    known_.clear();
    for (const std::string& path : paths)
        if (!path.empty()) known_.push_back(look_at(path));
    last_ = known_;
}

bool FileWatch::has_changed() {
    std::vector<Seen> now;
    for (const Seen& seen : known_) now.push_back(look_at(seen.path));
    const bool rests = now == last_;
    last_ = now;
    if (!rests || now == known_) return false;
    // An editor that replaces a file takes it away for a moment.
    for (const Seen& seen : now)
        if (seen.size == 0) return false;
    known_ = std::move(now);
    return true;
}

} // namespace app::viewer

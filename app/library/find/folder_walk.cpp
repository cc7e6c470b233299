#include "app/library/find/folder_walk.h"

#include <algorithm>
#include <deque>
#include <filesystem>
#include <set>

#include "app/library/find/name_pattern.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"
#include "gcode/language/program_folder.h"

namespace app {
namespace {

namespace fs = std::filesystem;

/// Reports access to a path that is not read or listed now, but may become a file or folder.
void note_presence(const fs::path& path) {
    core::notify_file_access({core::FileAccessKind::presence, path.generic_string(), {}, {}});
}

/// Walks through folders one after the other, links last.
class Walk {
public:
    explicit Walk(const fs::path& folder) {
        if (is_new(folder)) real_.push_back(folder);
        while (!real_.empty() || !linked_.empty()) {
            std::deque<fs::path>& next = real_.empty() ? linked_ : real_;
            const fs::path entered = next.front();
            next.pop_front();
            // The target of a link may have been entered since the link was found.
            if (&next == &linked_ && !is_new(entered)) continue;
            enter(entered);
        }
        std::sort(found.files.begin(), found.files.end());
        std::sort(found.folders.begin(), found.folders.end());
    }

    FolderWalk found;

private:
    bool is_new(const fs::path& folder) {
        const auto facts = core::platform::facts_of(folder);
        return !facts || seen_.insert({facts->device, facts->number}).second;
    }

    void enter(const fs::path& folder) {
        found.folders.push_back(folder);
        core::notify_file_access({core::FileAccessKind::listing, folder.generic_string(), {}, {}});
        std::error_code failure;
        // Sorted, as the choice among several links to a folder must not depend on the order on
        // disk.
        for (const std::string& name : gcode::names_in(folder, failure))
            if (!name.starts_with('.')) sort_in(folder / name);
        if (failure) found.unreadable.push_back(unreadable_folder(folder, failure));
    }

    void sort_in(const fs::path& path) {
        std::error_code failure;
        if (!fs::is_directory(path, failure))
            found.sort_in(path);
        else if (fs::is_symlink(path, failure)) {
            note_presence(path);
            linked_.push_back(path);
        } else if (is_new(path))
            real_.push_back(path);
    }

    std::deque<fs::path> real_, linked_;
    std::set<std::pair<uint64_t, uint64_t>> seen_;
};

} // namespace

void FolderWalk::sort_in(const fs::path& path) {
    std::error_code failure, ignored;
    const fs::file_status status = fs::status(path, failure);
    if (!fs::is_regular_file(status)) note_presence(path);
    const auto cannot = [&] {
        unreadable.push_back({core::ErrorCode::io,
                              {},
                              "cannot be accessed: " + failure.message(),
                              path.generic_string()});
    };
    const bool leads_nowhere = status.type() == fs::file_type::not_found
                               || failure == std::errc::too_many_symbolic_link_levels;
    if (failure && !leads_nowhere)
        cannot();
    else if (fs::is_regular_file(status))
        files.push_back(path.generic_string());
    else if (fs::exists(status))
        skipped.push_back({path.generic_string(), "is neither a file nor a folder"});
    else if (fs::is_symlink(fs::symlink_status(path, ignored)))
        skipped.push_back({path.generic_string(), "is a link that leads nowhere"});
    else if (failure != std::errc::no_such_file_or_directory) // deleted while the folder was listed
        cannot();
}

core::Error unreadable_folder(const fs::path& folder, const std::error_code& failure) {
    return {core::ErrorCode::io,
            {},
            "this folder cannot be read: " + failure.message(),
            folder.generic_string()};
}

FolderWalk walk_folder(const std::string& folder) {
    FolderWalk found = Walk(folder).found;
    std::sort(found.skipped.begin(), found.skipped.end(),
              [](const SkippedFile& a, const SkippedFile& b) { return a.path < b.path; });
    return found;
}

namespace {

namespace fs = std::filesystem;

class Expansion {
public:
    explicit Expansion(const fs::path& pattern) : root_(pattern.root_path()) {
        for (const fs::path& part : pattern.relative_path()) // `**/**` is `**`
            if (part != "**" || parts_.empty() || parts_.back() != "**") parts_.push_back(part);
    }

    FolderWalk run(const fs::path& folder) {
        expand(root_.empty() ? folder : folder / root_, 0);
        order(found_.files, std::less<>());
        order(found_.skipped, [](const auto& a, const auto& b) { return a.path < b.path; });
        order(found_.unreadable, [](const auto& a, const auto& b) { return a.file < b.file; });
        return std::move(found_);
    }

private:
    /// Sorts and removes duplicates: several parts of a pattern may reach the same folder.
    template <typename T, typename Less>
    static void order(std::vector<T>& all, Less less) {
        std::sort(all.begin(), all.end(), less);
        const auto same = [&](const T& a, const T& b) { return !less(a, b) && !less(b, a); };
        all.erase(std::unique(all.begin(), all.end(), same), all.end());
    }

    void expand(const fs::path& folder, size_t i) {
        if (i == parts_.size()) return;
        const fs::path& part = parts_[i];
        if (part == "**") return expand_below(folder, i);
        if (!is_glob(part.generic_string())) return go_on(folder / part, i);
        for (const std::string& name : names_of(folder.empty() ? fs::path(".") : folder))
            if (matches_pattern(part.generic_string(), name)) go_on(folder / name, i);
    }

    std::vector<std::string> names_of(const fs::path& folder) {
        core::notify_file_access({core::FileAccessKind::listing, folder.generic_string(), {}, {}});
        std::error_code failure;
        std::vector<std::string> names = gcode::names_in(folder, failure);
        if (failure) found_.unreadable.push_back(unreadable_folder(folder, failure));
        return names;
    }

    /// Expands `**` and the parts after it, here and in every folder below.
    void expand_below(const fs::path& folder, size_t i) {
        if (i + 1 == parts_.size()) parts_.push_back("*");
        FolderWalk below = walk_folder(folder.empty() ? "." : folder.generic_string());
        for (SkippedFile& file : below.skipped) found_.skipped.push_back(std::move(file));
        for (core::Error& error : below.unreadable) found_.unreadable.push_back(std::move(error));
        for (const fs::path& name : below.folders)
            expand(folder.empty() ? name.lexically_relative(".") : name, i + 1);
    }

    void go_on(const fs::path& path, size_t i) {
        const bool is_last = i + 1 == parts_.size();
        const auto what = core::presence_of(path);
        if (what == "folder") {
            if (!is_last) expand(path, i + 1);
        } else if (is_last || what != "file") {
            // A missing file that the pattern names without wildcards is not reported: its name was
            // not found on disk.
            if (is_glob(parts_[i].generic_string()) || what) found_.sort_in(path);
        }
    }

    fs::path root_; // empty: the pattern is relative
    std::vector<fs::path> parts_;
    FolderWalk found_;
};

} // namespace

bool is_glob(const std::string& word) { return word.find_first_of("*?[") != std::string::npos; }

FolderWalk files_of_glob(const fs::path& folder, const std::string& pattern) {
    return Expansion(pattern).run(folder);
}

fs::path folder_of_glob(const fs::path& folder, const std::string& pattern) {
    fs::path begin = folder;
    for (const fs::path& part : fs::path(pattern)) {
        if (is_glob(part.generic_string())) break;
        begin /= part;
    }
    return begin;
}

} // namespace app

#include "app/batch/glob.h"

#include <algorithm>
#include <filesystem>

#include <fnmatch.h>

#include "app/batch/folder_walk.h"
#include "core/base/file_reads.h"
#include "gcode/program_folder.h"

namespace app {
namespace {

namespace fs = std::filesystem;

class Expansion {
public:
    explicit Expansion(const fs::path& pattern) {
        for (const fs::path& part : pattern) // `**/**` is `**`
            if (part != "**" || parts_.empty() || parts_.back() != "**") parts_.push_back(part);
    }

    FolderWalk run(const fs::path& folder) {
        expand(folder, 0);
        order(found_.files, std::less<>());
        order(found_.skipped, [](const auto& a, const auto& b) { return a.path < b.path; });
        order(found_.unreadable, [](const auto& a, const auto& b) { return a.file < b.file; });
        return std::move(found_);
    }

private:
    /// Each once: two parts of a pattern may come by the same folder.
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
        if (!is_glob(part)) return go_on(folder / part, i);
        for (const std::string& name : names_of(folder.empty() ? fs::path(".") : folder))
            if (::fnmatch(part.c_str(), name.c_str(), FNM_PERIOD) == 0) go_on(folder / name, i);
    }

    std::vector<std::string> names_of(const fs::path& folder) {
        core::note_look({core::FileQuestion::listing, folder.string(), {}, {}});
        std::error_code failure;
        std::vector<std::string> names = gcode::names_in(folder, failure);
        if (failure) found_.unreadable.push_back(unreadable_folder(folder, failure));
        return names;
    }

    /// `**` and what comes behind it, here and in every folder below.
    void expand_below(const fs::path& folder, size_t i) {
        if (i + 1 == parts_.size()) parts_.push_back("*");
        FolderWalk below = walk_folder(folder.empty() ? "." : folder.string());
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
            // What a pattern spells out and is not there is no news: nobody has seen its name.
            if (is_glob(parts_[i]) || what) found_.sort_in(path);
        }
    }

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
        if (is_glob(part)) break;
        begin /= part;
    }
    return begin;
}

} // namespace app

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
    explicit Expansion(const fs::path& pattern) : parts_(pattern.begin(), pattern.end()) {}

    std::vector<std::string> run() {
        expand({}, 0);
        std::sort(files_.begin(), files_.end());
        files_.erase(std::unique(files_.begin(), files_.end()), files_.end());
        return std::move(files_);
    }

private:
    void expand(const fs::path& folder, size_t i) {
        if (i == parts_.size()) return;
        const fs::path& part = parts_[i];
        if (part == "**") return expand_below(folder, i);
        if (!is_glob(part)) return go_on(folder / part, i);
        const fs::path here = folder.empty() ? fs::path(".") : folder;
        core::note_look({core::FileQuestion::listing, here.string(), {}, {}});
        for (const std::string& name : gcode::names_in(here))
            if (::fnmatch(part.c_str(), name.c_str(), FNM_PERIOD) == 0) go_on(folder / name, i);
    }

    /// `**` and what comes behind it, here and in every folder below.
    void expand_below(const fs::path& folder, size_t i) {
        if (i + 1 == parts_.size()) parts_.push_back("*");
        expand(folder, i + 1);
        for (const fs::path& name : folders_below(folder)) expand(name, i + 1);
    }

    void go_on(const fs::path& path, size_t i) {
        std::error_code ignored;
        const bool is_folder = fs::is_directory(path, ignored);
        if (i + 1 < parts_.size()) {
            if (is_folder) expand(path, i + 1);
        } else if (!is_folder && fs::exists(path, ignored)) {
            files_.push_back(path.string());
        }
    }

    std::vector<fs::path> parts_;
    std::vector<std::string> files_;
};

} // namespace

bool is_glob(const std::string& word) { return word.find_first_of("*?[") != std::string::npos; }

std::vector<std::string> files_of_glob(const std::string& pattern) {
    return Expansion(pattern).run();
}

} // namespace app

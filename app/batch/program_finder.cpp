#include "app/batch/program_finder.h"

#include <set>

#include <fmt/format.h>

#include "app/batch/file_kind.h"
#include "app/batch/glob.h"
#include "app/batch/plain_path.h"

namespace app {
namespace {

namespace fs = std::filesystem;

class Finder {
public:
    FoundPrograms found;

    void take(const std::string& word) {
        std::error_code failure;
        if (fs::is_directory(word, failure)) return search(word);
        if (!fs::exists(fs::symlink_status(word, failure)) && is_glob(word)) return expand(word);
        add(word); // that it is there and can be read, its check says
    }

private:
    void search(const std::string& folder) {
        FolderWalk walk = walk_folder(folder);
        for (const SkippedFile& file : walk.skipped)
            found.skipped.push_back({plain_path(file.path), file.why});
        for (core::Error& error : walk.unreadable) found.failures.push_back(std::move(error));
        const size_t programs = look_into(walk.files);
        if (programs == 0 && walk.unreadable.empty()) fail(folder, "holds no NC program");
    }

    void expand(const std::string& pattern) {
        const std::vector<std::string> files = files_of_glob(pattern);
        if (files.empty()) return fail(pattern, "names no file");
        if (look_into(files) == 0) fail(pattern, "names no NC program");
    }

    /// How many of these files are programs, or may be.
    size_t look_into(const std::vector<std::string>& files) {
        size_t programs = 0;
        for (const std::string& given : files) {
            const std::string file = plain_path(given);
            auto why = why_no_program(file);
            if (why && *why) {
                found.skipped.push_back({file, **why});
                continue;
            }
            ++programs;
            if (why)
                add(file);
            else
                found.failures.push_back(why.error());
        }
        return programs;
    }

    void add(const std::string& file) {
        if (seen_.insert(plain_path(file)).second) found.programs.push_back(file);
    }

    void fail(const std::string& word, const std::string& why) {
        found.failures.push_back({core::ErrorCode::io, {}, why, word});
    }

    std::set<std::string> seen_;
};

} // namespace

FoundPrograms find_programs(const std::vector<std::string>& words) {
    Finder finder;
    for (const std::string& word : words) finder.take(word);
    return std::move(finder.found);
}

} // namespace app

#include "app/batch/program_finder.h"

#include <map>
#include <optional>
#include <set>

#include "app/batch/file_identity.h"
#include "app/batch/file_kind.h"
#include "app/batch/glob.h"
#include "app/batch/plain_path.h"
#include "app/batch/project_owner.h"
#include "core/base/file_reads.h"

namespace app {
namespace {

namespace fs = std::filesystem;

class Finder {
public:
    explicit Finder(fs::path folder) : folder_(std::move(folder)) {}

    FoundPrograms found;

    void take(const std::string& word) {
        const std::string path = folder_.empty() ? word : plain_path(folder_ / word);
        const auto what = core::presence_of(path);
        if (what == "folder") return search(plain_path(path));
        if ((!what || *what == "unknown") && is_glob(word)) return expand(word);
        if (what == "other") return fail(path, "is a pipe or a device; name it alone to check it");
        add(path); // that it is there and can be read, its check says
    }

private:
    void search(const std::string& folder) {
        const FolderWalk walk = walk_folder(folder);
        const bool has_programs = take_all(walk, folder);
        std::set<std::string> projects, unreadable;
        for (const core::Error& error : walk.unreadable) unreadable.insert(error.file);
        for (const fs::path& each : walk.folders)
            if (!unreadable.contains(each.string()) && !owners_.of(each, each).empty())
                projects.insert(plain_path(owners_.of(each, each)));
        found.projects.insert(found.projects.end(), projects.begin(), projects.end());
        if (!has_programs && projects.empty() && walk.unreadable.empty())
            fail(folder, "holds no NC program");
    }

    void expand(const std::string& pattern) {
        const FolderWalk matched = files_of_glob(folder_, pattern);
        const bool has_programs = take_all(matched, folder_of_glob(folder_, pattern));
        if (has_programs || !matched.unreadable.empty()) return;
        const bool is_any = !matched.files.empty() || !matched.skipped.empty();
        fail(plain_path(folder_ / pattern), is_any ? "names no NC program" : "names no file");
    }

    /// Whether there are programs among them, or what may be some.
    bool take_all(const FolderWalk& walk, const fs::path& top) {
        for (const SkippedFile& file : walk.skipped) skip(plain_path(file.path), file.why);
        for (core::Error error : walk.unreadable) {
            error.file = plain_path(error.file);
            found.failures.push_back(std::move(error));
        }
        bool has_programs = false;
        for (const std::string& file : walk.files) {
            const std::string owner = owners_.of(fs::path(file).parent_path(), top);
            const std::string project = owner.empty() ? owner : plain_path(owner);
            has_programs = take_file(plain_path(file), project) || has_programs;
        }
        return has_programs;
    }

    /// Whether it is a program, or may be one; it is looked into once.
    bool take_file(const std::string& file, const std::string& project) {
        const auto [known, is_new] = looked_into_.try_emplace(identities_.of(file));
        Look& look = known->second;
        if (look.place) {
            FoundProgram& program = found.programs[*look.place];
            // What a search finds that began below its project is to be checked in any case.
            if (program.project.empty() != project.empty()) program.is_named = true;
            if (!project.empty()) program.project = project;
        }
        if (!is_new) return look.may_be_program;
        core::note_look({core::FileQuestion::kind, file, {}, {}});
        auto why = why_no_program(file);
        look.may_be_program = !why || !*why;
        if (!why)
            found.failures.push_back(why.error());
        else if (*why)
            found.skipped.push_back({file, **why});
        else
            look.place = put(file, project);
        return look.may_be_program;
    }

    void add(const std::string& file) {
        Look& look = looked_into_[identities_.of(file)];
        if (!look.place) look = {true, put(file, {})};
        found.programs[*look.place].is_named = true;
    }

    size_t put(const std::string& file, const std::string& project) {
        found.programs.push_back({file, project, false});
        return found.programs.size() - 1;
    }

    void skip(const std::string& file, const std::string& why) {
        if (skipped_.insert(identities_.of(file)).second) found.skipped.push_back({file, why});
    }

    void fail(const std::string& word, const std::string& why) {
        found.failures.push_back({core::ErrorCode::io, {}, why, word});
    }

    /// What came of a file.
    struct Look {
        bool may_be_program = false;
        std::optional<size_t> place = {}; // among the programs
    };

    fs::path folder_;
    FileIdentities identities_;
    ProjectOwners owners_;
    std::map<std::string, Look> looked_into_;
    std::set<std::string> skipped_;
};

} // namespace

FoundPrograms find_programs(const std::vector<std::string>& words, const fs::path& folder) {
    Finder finder(folder);
    for (const std::string& word : words) finder.take(word);
    return std::move(finder.found);
}

} // namespace app

#include "app/batch/batch_job.h"

#include <map>

#include <fmt/format.h>

#include "app/batch/glob.h"
#include "app/batch/plain_path.h"
#include "app/batch/program_finder.h"
#include "app/batch/project_file.h"
#include "app/setup/setup_beside.h"

namespace app {
namespace {

namespace fs = std::filesystem;

/// The project file that a word stands for; empty for any other word.
std::string project_of(const std::string& word) {
    std::error_code ignored;
    if (fs::is_directory(word, ignored)) {
        const fs::path inside = fs::path(word) / project_file_name;
        return fs::is_regular_file(inside, ignored) ? inside.string() : std::string();
    }
    return fs::path(word).extension() == ".toml" && !is_glob(word) ? word : std::string();
}

class Planner {
public:
    explicit Planner(const CheckJob& asked) : asked_(asked) {}

    void take_words(const std::vector<std::string>& words) {
        FoundPrograms found = find_programs(words);
        for (core::Error& error : found.failures) plan_.failures.push_back(std::move(error));
        take(std::move(found), {});
    }

    void take_project(const Project& project) {
        for (const ProjectEntry& entry : project.entries) {
            FoundPrograms found = find_programs(entry.files);
            for (const core::Error& error : found.failures)
                plan_.failures.push_back({error.code,
                                          {entry.line, 0, 0},
                                          fmt::format("{} {}", error.file, error.message),
                                          project.path});
            // What a project says of all programs must not hide what an earlier table says of some.
            take(std::move(found), entry.terms, project.terms);
        }
    }

    BatchPlan finish() && {
        for (size_t i = 0; i < programs_.size(); ++i)
            plan_.jobs.push_back(job_of(programs_[i], terms_[i]));
        return std::move(plan_);
    }

private:
    void take(FoundPrograms found, const ProgramTerms& terms, const ProgramTerms& general = {}) {
        for (std::string& program : found.programs) {
            const std::string name = plain_path(program);
            const auto [at, is_new] = place_of_.try_emplace(name, programs_.size());
            if (is_new) {
                programs_.push_back(std::move(program));
                terms_.push_back(general);
            }
            terms_[at->second] = overlaid(std::move(terms_[at->second]), terms);
        }
        for (SkippedFile& file : found.skipped) plan_.skipped.push_back(std::move(file));
    }

    CheckJob job_of(const std::string& program, const ProgramTerms& terms) const {
        CheckJob job = asked_;
        job.program = program;
        if (job.setup.empty()) job.setup = terms.setup;
        look_beside(job);
        if (!job.settings.dialect) job.settings.dialect = terms.dialect;
        if (!job.allowance) job.allowance = terms.allowance;
        if (!job.mesh_size) job.mesh_size = terms.mesh_size;
        job.rules.insert(terms.rules.begin(), terms.rules.end());
        return job;
    }

    const CheckJob& asked_;
    std::vector<std::string> programs_;
    std::vector<ProgramTerms> terms_; // of each program
    std::map<std::string, size_t> place_of_;
    BatchPlan plan_;
};

} // namespace

bool is_one_program(const std::vector<std::string>& words) {
    if (words.size() != 1 || !project_of(words[0]).empty()) return false;
    std::error_code ignored;
    if (fs::is_directory(words[0], ignored)) return false;
    return !is_glob(words[0]) || fs::exists(fs::symlink_status(words[0], ignored));
}

core::Result<BatchPlan> plan_batch(const std::vector<std::string>& words, const CheckJob& asked) {
    Planner planner(asked);
    std::vector<std::string> plain; // words in a row that name no project
    for (const std::string& word : words) {
        const std::string path = project_of(word);
        if (path.empty()) {
            plain.push_back(word);
            continue;
        }
        planner.take_words(std::exchange(plain, {}));
        FEELER_TRY(const Project project, read_project(path));
        planner.take_project(project);
    }
    planner.take_words(plain);
    return std::move(planner).finish();
}

} // namespace app

#include "app/library/run/batch_job.h"

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/library/find/folder_walk.h"
#include "app/library/find/program_choice.h"
#include "app/setup/setup_file.h"
#include "core/base/file_reads.h"

namespace app {
namespace {

namespace fs = std::filesystem;

/// The project file that an argument refers to; empty for any other argument.
std::string project_of(const std::string& word) {
    std::error_code ignored;
    if (fs::is_directory(word, ignored)) {
        const fs::path inside = fs::path(word) / project_file_name;
        return core::is_there(inside) ? inside.generic_string() : std::string();
    }
    const bool is_pattern = is_glob(word) && !core::is_there(word);
    return fs::path(word).extension() == ".toml" && !is_pattern ? word : std::string();
}

CheckJob job_of(const ChosenProgram& chosen, const CheckJob& asked) {
    // General settings of a project must not override an earlier table for some programs.
    const ProgramTerms terms = overlaid(chosen.general, chosen.special);
    CheckJob job = asked;
    job.program = chosen.path;
    if (job.setup.empty()) job.setup = terms.setup;
    find_setup_next_to(job);
    if (!job.settings.dialect) job.settings.dialect = terms.dialect;
    if (!job.allowance) job.allowance = terms.allowance;
    if (!job.mesh_size) job.mesh_size = terms.mesh_size;
    job.rules.insert(terms.rules.begin(), terms.rules.end());
    return job;
}

} // namespace

bool is_one_program(const std::vector<std::string>& words) {
    if (words.size() != 1 || !project_of(words[0]).empty()) return false;
    if (core::is_folder(words[0])) return false;
    std::error_code ignored;
    return !is_glob(words[0]) || fs::exists(fs::symlink_status(words[0], ignored));
}

core::Result<BatchPlan> plan_batch(const std::vector<std::string>& words, const CheckJob& asked) {
    ProgramChooser chooser;
    std::vector<std::string> plain; // successive arguments without a project
    for (const std::string& word : words) {
        const std::string path = project_of(word);
        if (path.empty()) {
            plain.push_back(word);
            continue;
        }
        chooser.add_words(std::exchange(plain, {}));
        if (auto read = chooser.add_project(path); !read) return tl::unexpected(read.error());
    }
    chooser.add_words(plain);
    const ProgramChoice choice = std::move(chooser).finish();
    BatchPlan plan{.jobs = {}, .skipped = choice.skipped(), .failures = choice.failures()};
    for (const ChosenProgram& chosen : choice.programs())
        plan.jobs.push_back(job_of(chosen, asked));
    return plan;
}

} // namespace app

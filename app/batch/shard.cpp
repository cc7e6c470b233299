#include "app/batch/shard.h"

#include <cassert>
#include <filesystem>

#include <fmt/format.h>

#include "app/batch/input_files.h"
#include "app/batch/result_key.h"
#include "app/session/digest.h"
#include "app/setup/utf8_text.h"

namespace app {
namespace {

uintmax_t file_size_or_zero(const std::string& path) {
    std::error_code failure;
    const uintmax_t size = std::filesystem::file_size(path, failure);
    return failure ? 0 : size;
}

/// What a result's key does not hold: whether there is memory enough, and what is in the files that
/// the results of the database are held against one by one.
std::string terms_of(const CheckJob& job, InputAnswers& answers) {
    std::string terms = options_text(job).value_or("");
    terms += job.memory_limit ? fmt::format(" {}", *job.memory_limit) : std::string();
    const ProgramSettings& settings = job.settings;
    for (const std::string& path :
         {job.setup, settings.ini, settings.parameters, settings.tool_table})
        terms += " " + (path.empty() ? std::string() : answers.content_of(path));
    return result_key({}, job, {}, terms);
}

} // namespace

std::vector<PlannedProgram> planned_programs(const BatchPlan& plan) {
    InputAnswers answers;
    std::vector<PlannedProgram> programs;
    for (const CheckJob& job : plan.jobs)
        programs.push_back(
            {utf8_text(job.program), file_size_or_zero(job.program), terms_of(job, answers)});
    return programs;
}

std::vector<size_t> places_of(const std::vector<PlannedProgram>& programs, const ShareName& share) {
    std::vector<uintmax_t> sizes;
    for (const PlannedProgram& program : programs) sizes.push_back(program.size);
    return share_of(sizes, share);
}

BatchPlan plan_of_places(const BatchPlan& plan, const std::vector<size_t>& places) {
    BatchPlan part{.jobs = {}, .skipped = plan.skipped, .failures = plan.failures};
    for (const size_t place : places) part.jobs.push_back(plan.jobs[place]);
    return part;
}

Shard shard_of(Shard shard, const std::vector<size_t>& places, const BatchResult& batch) {
    const size_t checked = places.size() - batch.unchecked.size();
    assert(checked <= batch.programs.size());
    // Both are in the order of the places, and what is not among the results was not checked.
    for (const size_t place : places) {
        const size_t next = shard.results.size();
        if (next < checked && batch.programs[next].program == shard.programs[place].name) {
            shard.places.push_back(place);
            shard.results.push_back(batch.programs[next]);
        } else {
            shard.unchecked.push_back(place);
        }
    }
    shard.failures.assign(batch.programs.begin() + static_cast<std::ptrdiff_t>(checked),
                          batch.programs.end());
    shard.skipped = batch.skipped;
    return shard;
}

} // namespace app

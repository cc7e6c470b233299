#include "app/library/shard/shard.h"

#include <cassert>
#include <charconv>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/base/sha256.h"
#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/library/result/stored_json.h"
#include "app/library/run/batch_job.h"
#include "app/library/store/input_files.h"
#include "app/library/store/result_key.h"
#include "app/setup/program_settings.h"
#include "core/base/file_reads.h"

namespace app {
namespace {

uintmax_t file_size_or_zero(const std::string& path) {
    std::error_code failure;
    const uintmax_t size = std::filesystem::file_size(path, failure);
    return failure ? 0 : size;
}

/// A digest of what result_key leaves out: the memory limit, and the content of the files that a
/// stored result is otherwise compared with one by one.
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

std::vector<size_t> indices_of(const std::vector<PlannedProgram>& programs, const ShardId& id) {
    std::vector<uintmax_t> sizes;
    for (const PlannedProgram& program : programs) sizes.push_back(program.size);
    return indices_of_shard(sizes, id);
}

BatchPlan part_of_plan(const BatchPlan& plan, const std::vector<size_t>& indices) {
    BatchPlan part{.jobs = {}, .skipped = plan.skipped, .failures = plan.failures};
    for (const size_t index : indices) part.jobs.push_back(plan.jobs[index]);
    return part;
}

Shard shard_of(Shard shard, const std::vector<size_t>& indices, const BatchResult& batch) {
    const size_t checked = indices.size() - batch.unchecked.size();
    assert(checked <= batch.programs.size());
    // Both are in the order of the places; a program without a result was not checked.
    for (const size_t index : indices) {
        const size_t next = shard.results.size();
        if (next < checked && batch.programs[next].program == shard.programs[index].name) {
            shard.indices.push_back(index);
            shard.results.push_back(batch.programs[next]);
        } else {
            shard.unchecked.push_back(index);
        }
    }
    shard.failures.assign(batch.programs.begin() + static_cast<std::ptrdiff_t>(checked),
                          batch.programs.end());
    shard.skipped = batch.skipped;
    return shard;
}

namespace {

using Json = StoredJson;

constexpr int shard_format = 1;
constexpr std::string_view beginning = "{\"feeler_shard\"";
constexpr double longest = 1e10; // seconds, three centuries

Json json_of(const PlannedProgram& program) { return {program.name, program.size, program.terms}; }

PlannedProgram program_from(const Json& json) {
    list_from(json, 3);
    return {json[0], whole_from<uintmax_t>(json[1]), json[2]};
}

Json json_of(const SkippedFile& file) { return {file.path, file.why}; }

SkippedFile skipped_from(const Json& json) {
    const auto [path, why] = pair_from(json);
    return {path, why};
}

/// A list with one entry per line.
template <typename Entries, typename TextOf>
std::string list_text(const char* key, const Entries& entries, TextOf text_of_entry) {
    std::string text = fmt::format(",\n\"{}\": [", key);
    for (size_t i = 0; i < entries.size(); ++i)
        text += (i == 0 ? "\n" : ",\n") + text_of_entry(entries[i]);
    return text + "]";
}

std::vector<size_t> indices_from(const Json& json) {
    std::vector<size_t> indices;
    for (const Json& each : list_from(json)) indices.push_back(whole_from<size_t>(each));
    return indices;
}

core::Result<std::vector<ProgramResult>> results_from(const Json& json) {
    std::vector<ProgramResult> results;
    for (const Json& each : list_from(json)) {
        FEELER_TRY(ProgramResult result, result_from_json(each.dump()));
        results.push_back(std::move(result));
    }
    return results;
}

core::Result<Shard> shard_from(const Json& json) {
    if (whole_from<int>(json.at("feeler_shard")) != shard_format)
        throw std::invalid_argument("its format is unknown");
    Shard shard;
    shard.version = json.at("version");
    const Json& id = list_from(json.at("share"), 2);
    FEELER_TRY(shard.id,
               shard_named(text_of(ShardId{whole_from<size_t>(id[0]), whole_from<size_t>(id[1])})));
    shard.seconds = number_from(json.at("seconds"), 0.0);
    if (shard.seconds > longest) throw std::invalid_argument("its time is out of range");
    for (const Json& each : list_from(json.at("programs")))
        shard.programs.push_back(program_from(each));
    for (const Json& each : list_from(json.at("skipped")))
        shard.skipped.push_back(skipped_from(each));
    shard.indices = indices_from(json.at("places"));
    shard.unchecked = indices_from(json.at("unchecked"));
    FEELER_TRY(shard.failures, results_from(json.at("failures")));
    FEELER_TRY(shard.results, results_from(json.at("results")));
    return shard;
}

/// The last entry: the digest of everything before it.
std::string seal_of(std::string_view text) {
    return fmt::format(",\n\"seal\": \"{}\"}}\n", sha256_of(text));
}

bool is_sealed(std::string_view text) {
    const size_t length = seal_of("").size();
    if (text.size() < length) return false;
    const std::string_view before = text.substr(0, text.size() - length);
    return text.substr(before.size()) == seal_of(before);
}

/// Whether it is a shard in a later format. A newer version may compute the seal differently.
bool is_newer(const std::string& text) {
    const size_t colon = text.find(": ", beginning.size());
    int number = 0;
    if (colon != beginning.size()) return false;
    const auto [end, wrong] =
        std::from_chars(text.data() + colon + 2, text.data() + text.size(), number);
    return wrong == std::errc() && number > shard_format && (*end == ',' || *end == '}');
}

} // namespace

std::string sealed(std::string text) { return text + seal_of(text); }

std::string json_of(const Shard& shard) {
    const auto line = [](const auto& entry) { return json_text(json_of(entry)); };
    const auto result_line = [](const ProgramResult& result) { return json_of(result); };
    std::string json = fmt::format(
        "{{\"feeler_shard\": {}, \"version\": {}, \"share\": [{}, {}], \"seconds\": {},\n"
        "\"places\": [{}],\n\"unchecked\": [{}]",
        shard_format, json_text(shard.version), shard.id.i, shard.id.n, json_text(shard.seconds),
        fmt::join(shard.indices, ","), fmt::join(shard.unchecked, ","));
    json += list_text("programs", shard.programs, line);
    json += list_text("skipped", shard.skipped, line);
    json += list_text("failures", shard.failures, result_line);
    return sealed(json + list_text("results", shard.results, result_line));
}

core::Result<Shard> shard_from_json(const std::string& text) {
    if (!text.starts_with(beginning))
        return core::fail(core::ErrorCode::syntax,
                          "is not a shard of a batch: --format shard writes one");
    if (is_newer(text))
        return core::fail(core::ErrorCode::unsupported, "was written by a newer version of Feeler");
    if (!is_sealed(text))
        return core::fail(core::ErrorCode::syntax,
                          "is a shard of a batch that was truncated or changed");
    try {
        return shard_from(parsed_stored_json(text));
    } catch (const std::exception& wrong) {
        return core::fail(core::ErrorCode::syntax,
                          fmt::format("is not a shard of a batch: {}", wrong.what()));
    }
}

bool is_shard_file(const std::string& path) {
    const auto text = core::file_bytes(path, beginning.size());
    return text && text->starts_with(beginning);
}

} // namespace app

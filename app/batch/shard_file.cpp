#include "app/batch/shard_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int format = 1;

std::string text_of(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json json_of(const PlannedProgram& program) { return {program.name, program.size, program.terms}; }

PlannedProgram program_from(const Json& json) { return {json.at(0), json.at(1), json.at(2)}; }

Json json_of(const SkippedFile& file) { return {file.path, file.why}; }

SkippedFile skipped_from(const Json& json) { return {json.at(0), json.at(1)}; }

/// An entry to a line.
template <typename Entries, typename TextOf>
std::string list_text(const char* key, const Entries& entries, TextOf text_of_entry) {
    std::string text = fmt::format(",\n\"{}\": [", key);
    for (size_t i = 0; i < entries.size(); ++i)
        text += (i == 0 ? "\n" : ",\n") + text_of_entry(entries[i]);
    return text + "]";
}

core::Result<std::vector<ProgramResult>> results_from(const Json& list) {
    std::vector<ProgramResult> results;
    for (const Json& each : list) {
        FEELER_TRY(ProgramResult result, result_from_json(each.dump()));
        results.push_back(std::move(result));
    }
    return results;
}

core::Result<Shard> shard_from(const Json& json) {
    Shard shard;
    shard.version = json.at("version");
    const Json& share = json.at("share");
    FEELER_TRY(shard.share, share_named(share.at(0).dump() + "/" + share.at(1).dump()));
    shard.seconds = json.at("seconds");
    for (const Json& each : json.at("programs")) shard.programs.push_back(program_from(each));
    for (const Json& each : json.at("skipped")) shard.skipped.push_back(skipped_from(each));
    shard.places = json.at("places").get<std::vector<size_t>>();
    shard.unchecked = json.at("unchecked").get<std::vector<size_t>>();
    FEELER_TRY(shard.failures, results_from(json.at("failures")));
    FEELER_TRY(shard.results, results_from(json.at("results")));
    return shard;
}

} // namespace

std::string json_of(const Shard& shard) {
    const auto line = [](const auto& entry) { return text_of(json_of(entry)); };
    const auto result_line = [](const ProgramResult& result) { return json_of(result); };
    std::string json = fmt::format(
        "{{\"feeler_shard\": {}, \"version\": {}, \"share\": [{}, {}], \"seconds\": {},\n"
        "\"places\": [{}],\n\"unchecked\": [{}]",
        format, text_of(shard.version), shard.share.i, shard.share.n, text_of(shard.seconds),
        fmt::join(shard.places, ","), fmt::join(shard.unchecked, ","));
    json += list_text("programs", shard.programs, line);
    json += list_text("skipped", shard.skipped, line);
    json += list_text("failures", shard.failures, result_line);
    return json + list_text("results", shard.results, result_line) + "}\n";
}

core::Result<Shard> shard_from_json(const std::string& text) {
    try {
        const Json json = Json::parse(text, nullptr, false);
        const bool is_one = json.is_object() && json.contains("feeler_shard");
        if (is_one && json["feeler_shard"] == format) return shard_from(json);
        if (is_one && json["feeler_shard"] > format)
            return core::fail(core::ErrorCode::unsupported,
                              "was written by a newer version of Feeler");
        return core::fail(core::ErrorCode::syntax,
                          text.starts_with("{\"feeler_shard\"")
                              ? "is a share of a batch that was cut off or changed"
                              : "is no share of a batch: --format shard writes one");
    } catch (const std::exception& wrong) {
        return core::fail(core::ErrorCode::syntax,
                          fmt::format("is no share of a batch: {}", wrong.what()));
    }
}

} // namespace app

#include <algorithm>
#include <map>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/sha256.h"
#include "app/base/version.h"
#include "app/library/result/program_diff.h"
#include "app/library/result/stored_json.h"
#include "app/report/exchange/exchange_reports.h"
#include "app/report/text/batch_text.h"
#include "core/sim/finding.h"

namespace app {
namespace {

using Json = nlohmann::ordered_json;

/// Id for a program that stopped early; not a rule of the set-up.
constexpr const char* not_run = "not-run-to-its-end";

/// Id for a program that was not checked because the batch was stopped. A result is needed: hosts
/// show a file without results as passed.
constexpr const char* not_checked = "not-checked";

/// Code hosts refuse a file with more.
constexpr size_t most_results = 25'000;

const char* level_of(core::Severity severity) {
    return severity == core::Severity::off ? "none" : core::name_of(severity);
}

Json rule_json(std::string_view name, std::string_view title, std::string_view meaning,
               std::string_view cure, core::Severity severity) {
    return {{"id", name},
            {"name", title},
            {"shortDescription", {{"text", meaning}}},
            {"fullDescription", {{"text", meaning}}},
            {"help", {{"text", cure}}},
            {"defaultConfiguration", {{"level", level_of(severity)}}}};
}

Json rules_json() {
    Json rules = Json::array();
    for (const core::RuleEntry& rule : core::rule_table())
        rules.push_back(rule_json(rule.name, rule.title, rule.meaning, rule.cure, rule.severity));
    rules.push_back(
        rule_json(not_run, "Not run to its end",
                  "The program, or its set-up, could not be read or run to its end.",
                  "Correct the error in the message; everything after it was not checked.",
                  core::Severity::error));
    rules.push_back(rule_json(not_checked, "Not checked",
                              "The run ended before this program was checked.",
                              "Check the program again.", core::Severity::error));
    return rules;
}

size_t index_of(const std::string& rule) {
    const auto rules = core::rule_table();
    const auto found = std::find_if(rules.begin(), rules.end(), [&](const core::RuleEntry& entry) {
        return entry.name == rule;
    });
    const size_t extra = rule == not_checked ? 1 : 0; // `not_run` follows the last rule
    return static_cast<size_t>(found - rules.begin()) + extra;
}

/// A location in a file; line 1 if none is known, because code hosts show nothing otherwise. The
/// file name has the bytes that are on disk.
Json location_json(const std::string& file, const FileBytes& bytes, uint32_t line,
                   uint32_t column) {
    const std::string uri = uri_of(name_shown_as(file, bytes));
    Json artifact = {{"uri", uri}};
    if (!uri.starts_with("file:")) artifact["uriBaseId"] = "%SRCROOT%";
    return {
        {"physicalLocation",
         {{"artifactLocation", artifact},
          {"region", {{"startLine", std::max(line, 1U)}, {"startColumn", std::max(column, 1U)}}}}}};
}

Json finding_json(const ProgramResult& program, const StoredFinding& finding, size_t before) {
    const std::string& file = finding.file.empty() ? program.program : finding.file;
    const std::string cure = finding.cure.empty() ? "" : " " + finding.cure;
    Json json = {
        {"ruleId", finding.rule},
        {"ruleIndex", index_of(finding.rule)},
        {"level", level_of(finding.severity)},
        {"message", {{"text", finding.message + cure}}},
        {"locations", Json::array({location_json(file, program.file_bytes, finding.line, 1)})},
        {"partialFingerprints", {{"feeler/v1", fingerprint_of(finding, before)}}}};
    json["properties"] = {{"program", program.program}, {"shortfall", finding.shortfall}};
    if (finding.block) json["properties"]["block"] = core::value_of(*finding.block);
    return json;
}

Json error_json(const ProgramResult& program) {
    const StoredError& error = *program.error;
    return {
        {"ruleId", not_run},
        {"ruleIndex", index_of(not_run)},
        {"level", "error"},
        {"message", {{"text", error.message}}},
        {"locations", Json::array({location_json(error.file.empty() ? program.program : error.file,
                                                 program.file_bytes, error.line, error.column)})},
        {"partialFingerprints",
         {{"feeler/v1", sha256_of(std::string(not_run) + "\n" + error.message)}}}};
}

Json unchecked_json(const std::string& program, const FileBytes& bytes) {
    return {{"ruleId", not_checked},
            {"ruleIndex", index_of(not_checked)},
            {"level", "error"},
            {"message", {{"text", "This program was not checked."}}},
            {"locations", Json::array({location_json(program, bytes, 1, 1)})},
            {"partialFingerprints", {{"feeler/v1", sha256_of(not_checked)}}}};
}

/// Order in which results are kept if there are too many: errors first, then by the number of worse
/// findings in the same program, which are kept before it.
using Urgency = std::pair<int, size_t>;

/// The urgency of each finding of a program. Programs that stopped early or were not checked have
/// {0, 0}.
std::vector<Urgency> urgencies_of(const std::vector<StoredFinding>& findings) {
    std::vector<size_t> worst_first(findings.size());
    std::iota(worst_first.begin(), worst_first.end(), size_t(0));
    std::stable_sort(worst_first.begin(), worst_first.end(), [&](size_t a, size_t b) {
        const StoredFinding &one = findings[a], &other = findings[b];
        if (one.severity != other.severity) return one.severity > other.severity;
        return one.shortfall > other.shortfall;
    });
    std::vector<Urgency> urgencies(findings.size());
    for (size_t rank = 0; rank < worst_first.size(); ++rank) {
        const core::Severity severity = findings[worst_first[rank]].severity;
        const int milder = static_cast<int>(core::Severity::error) - static_cast<int>(severity);
        urgencies[worst_first[rank]] = {milder, rank};
    }
    return urgencies;
}

/// Which results to write, in the order of results_json.
std::vector<bool> chosen_results(const BatchResult& batch) {
    std::vector<Urgency> all;
    for (const ProgramResult& program : batch.programs) {
        const std::vector<Urgency> urgencies = urgencies_of(program.findings);
        all.insert(all.end(), urgencies.begin(), urgencies.end());
        if (program.error) all.push_back({0, 0});
    }
    all.resize(all.size() + batch.unchecked.size());
    std::vector<size_t> order(all.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return all[a] < all[b]; });
    std::vector<bool> is_chosen(all.size(), false);
    for (size_t i = 0; i < std::min(order.size(), most_results); ++i) is_chosen[order[i]] = true;
    return is_chosen;
}

Json results_json(const BatchResult& batch, const std::vector<bool>& is_chosen) {
    Json results = Json::array();
    size_t next = 0;
    for (const ProgramResult& program : batch.programs) {
        std::map<std::string, size_t> seen; // by the fingerprint for `before` = 0
        for (const StoredFinding& finding : program.findings) {
            const size_t before = seen[fingerprint_of(finding, 0)]++;
            if (is_chosen[next++]) results.push_back(finding_json(program, finding, before));
        }
        if (program.error && is_chosen[next++]) results.push_back(error_json(program));
    }
    for (const std::string& program : batch.unchecked)
        if (is_chosen[next++]) results.push_back(unchecked_json(program, batch.file_bytes));
    return results;
}

Json notification_json(const std::string& level, const std::string& text) {
    return {{"level", level}, {"message", {{"text", text}}}};
}

Json notification_json(const std::string& level, const std::string& text, const Json& location) {
    Json json = notification_json(level, text);
    json["locations"] = Json::array({location});
    return json;
}

/// A note for each skipped file, or one note for many files skipped for the same reason, because
/// code hosts refuse very large files.
void add_skipped(Json& notes, const BatchResult& batch) {
    constexpr size_t few = 100;
    for (const SkippedGroup& group : skipped_groups(batch.skipped)) {
        const size_t count = group.files.size();
        const bool each = count <= few;
        if (!each)
            notes.push_back(notification_json(
                "note", fmt::format("this and {} more were skipped: {}", count - 1, group.why),
                location_json(group.files[0], batch.file_bytes, 1, 1)));
        for (size_t i = 0; each && i < count; ++i)
            notes.push_back(
                notification_json("note", "was skipped: " + group.why,
                                  location_json(group.files[i], batch.file_bytes, 1, 1)));
    }
}

/// A note for each set of things that were not checked, at the first program that it is true of.
void add_uncovered(Json& notes, const BatchResult& batch) {
    std::map<std::string, std::vector<const ProgramResult*>> programs; // by text
    for (const ProgramResult& program : batch.programs)
        if (const std::string uncovered = uncovered_text(program); !uncovered.empty())
            programs[headline_of(program) + ". Not checked: " + uncovered].push_back(&program);
    for (const auto& [text, some] : programs) {
        const std::string others =
            some.size() == 1 ? "" : fmt::format(" (this program and {} more)", some.size() - 1);
        notes.push_back(notification_json(
            "note", text + others, location_json(some[0]->program, some[0]->file_bytes, 1, 1)));
    }
}

Json invocation_json(const BatchResult& batch, const std::vector<bool>& is_chosen) {
    Json notes = Json::array();
    if (const auto left_out = std::count(is_chosen.begin(), is_chosen.end(), false); left_out > 0)
        notes.push_back(notification_json(
            "warning",
            fmt::format("omitted: {} of the results, because code hosts accept at most {} per run; "
                        "the worst are listed here; --format json lists all",
                        left_out, most_results)));
    for (const ProgramResult& program : batch.programs)
        if (program.error) {
            const StoredError& error = *program.error;
            notes.push_back(
                notification_json("error", error.message,
                                  location_json(error.file.empty() ? program.program : error.file,
                                                program.file_bytes, error.line, error.column)));
        }
    add_uncovered(notes, batch);
    for (const std::string& program : batch.unchecked)
        notes.push_back(notification_json("error", "was not checked",
                                          location_json(program, batch.file_bytes, 1, 1)));
    add_skipped(notes, batch);
    return {{"executionSuccessful", status_of(batch) != 2},
            {"exitCode", status_of(batch)},
            {"toolExecutionNotifications", notes}};
}

} // namespace

std::string uri_of(const std::string& path) {
    // On Windows a path may begin with a drive, "C:", or with a server, "//server".
    const std::string root = std::filesystem::path(path).root_name().generic_string();
    std::string uri = root.starts_with('/')   ? "file:" + root
                      : !root.empty()         ? "file:///" + root
                      : path.starts_with('/') ? "file://"
                                              : "";
    for (const char c : path.substr(root.size())) {
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')
                              || (c >= '0' && c <= '9')
                              || std::string_view("-._~/").find(c) != std::string_view::npos;
        if (is_plain)
            uri += c;
        else
            uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return uri;
}

std::string fingerprint_of(const StoredFinding& finding, size_t before) {
    return sha256_of(fmt::format("{}\n{}\n{}\n{}\n{}", finding.rule, finding.pair[0],
                                 finding.pair[1], without_number(finding.text), before));
}

std::string sarif_report(const BatchResult& batch, const std::string& folder) {
    const std::string root = uri_of(folder);
    const std::vector<bool> is_chosen = chosen_results(batch);
    const Json driver = {{"name", "Feeler"},
                         {"version", version},
                         {"semanticVersion", version},
                         {"rules", rules_json()}};
    Json run = {
        {"tool", {{"driver", driver}}},
        {"invocations", Json::array({invocation_json(batch, is_chosen)})},
        {"originalUriBaseIds", {{"%SRCROOT%", {{"uri", root.ends_with('/') ? root : root + "/"}}}}},
        {"columnKind", "unicodeCodePoints"},
        {"results", results_json(batch, is_chosen)}};
    if (batch.programs.size() == 1) {
        const ProgramResult& only = batch.programs[0];
        run["properties"] = {{"headline", headline_of(only)}};
        if (only.coverage) run["properties"]["coverage"] = json_of(*only.coverage);
    }
    if (!batch.shard.empty()) run["automationDetails"] = {{"description", {{"text", batch.shard}}}};
    const Json log = {{"$schema", "https://json.schemastore.org/sarif-2.1.0.json"},
                      {"version", "2.1.0"},
                      {"runs", Json::array({run})}};
    return log.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace app

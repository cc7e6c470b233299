#include "app/report/json/json_report.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/version.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/stock_file.h"
#include "app/library/result/stored_json.h"
#include "app/tolerance/tolerances.h"
#include "core/base/rule.h"
#include "core/sim/part_comparison.h"
#include "gcode/language/dialect.h"

namespace app {
namespace {

using Json = nlohmann::ordered_json;

Json array_of(const core::Vec3& p) { return Json::array({p.x, p.y, p.z}); }

Json bounds_of(const core::PairClearance& pair) {
    Json clearance;
    clearance["lower"] = pair.lower;
    clearance["upper"] = pair.found() ? Json(pair.upper) : Json(nullptr);
    return clearance;
}

Json names_of(const CheckRun& run, const core::PairClearance& pair) {
    return Json::array(
        {core::part_name(run.setup, pair.pair), core::body_name(run.setup, pair.pair)});
}

void add_pair(Json& json, const CheckRun& run, const core::PairClearance& pair, double duration) {
    json["clearance"] = bounds_of(pair);
    json["allowance"] = pair.allowance.distance;
    json["pair"] = names_of(run, pair);
    const bool found = pair.found();
    json["at"] = found ? Json(duration > 0.0 ? pair.time / duration : 0.0) : Json(nullptr);
    json["witness"] =
        found ? Json::array({array_of(pair.on_tool), array_of(pair.on_body)}) : Json(nullptr);
}

/// For a motion without a measured pair: none came within the search limit, none had to be
/// measured, or nothing is known.
void add_no_pair(Json& json, const CheckRun& run, const core::BlockResult& result) {
    json["clearance"] = {{"lower", least_clearance(run.setup, result)}, {"upper", nullptr}};
    for (const char* key : {"allowance", "pair", "at", "witness"}) json[key] = nullptr;
}

Json block_json(const CheckRun& run, const CheckedBlock& block,
                const std::vector<std::string>& rules, bool pairs) {
    const core::BlockResult& result = block.result;
    Json json;
    json["block"] = core::value_of(block.block);
    if (!block.file.empty()) json["file"] = block.file;
    json["line"] = block.line;
    json["calls"] = block.calls;
    json["text"] = block.text;
    json["motion"] = core::name_of(result.motion);
    json["tool"] = result.tool ? Json(core::value_of(*result.tool)) : Json(nullptr);
    json["time"] = result.time;
    json["duration"] = result.duration;
    json["removed"] = result.removed;
    if (result.motion != core::BlockMotion::none) {
        if (result.deciding)
            add_pair(json, run, result.pairs[*result.deciding], result.duration);
        else
            add_no_pair(json, run, result);
    }
    json["verdict"] = core::name_of(result.verdict);
    json["rules"] = rules;
    if (!pairs) return json;
    json["pairs"] = Json::array();
    for (const core::PairClearance& pair : result.pairs) {
        Json entry;
        add_pair(entry, run, pair, result.duration);
        entry["verdict"] = core::name_of(pair.verdict);
        json["pairs"].push_back(std::move(entry));
    }
    return json;
}

Json finding_json(const CheckRun& run, const core::Finding& finding) {
    Json json;
    json["rule"] = finding.rule;
    json["title"] = core::title_of_rule(finding.rule);
    json["severity"] = core::name_of(finding.severity);
    json["block"] = nullptr;
    json["line"] = nullptr;
    if (finding.block) {
        json["block"] = core::value_of(*finding.block);
        json["line"] = run.blocks.line(core::value_of(*finding.block));
    }
    if (!finding.pair[0].empty()) json["pair"] = finding.pair;
    json["message"] = finding.message;
    json["cure"] = finding.cure;
    if (const auto& overlap = finding.overlap) {
        json["depth"] = {{"least", overlap->least},
                         {"most", overlap->most ? Json(*overlap->most) : Json(nullptr)}};
        json["way_out"] = overlap->most ? array_of(overlap->way_out) : Json(nullptr);
    }
    return json;
}

Json error_json(const core::Error& error) {
    Json json;
    json["file"] = error.file;
    json["line"] = error.where.line;
    json["column"] = error.where.column;
    json["message"] = error.message;
    return json;
}

/// What other readings of the premises that the set-up leaves open give.
Json readings_json(const CheckRun& run) {
    Json all = Json::array();
    for (const ReadingResult& reading : run.readings) {
        Json json;
        json["block"] = reading.block;
        json["line"] = reading.line;
        if (!reading.file.empty()) json["file"] = reading.file;
        json["assumed"] = reading.premise.assumed;
        json["if"] = reading.when;
        json["effect"] = reading.effect;
        json["verdict"] = core::name_of(reading.verdict);
        json["error_count"] = reading.error_count;
        if (reading.ends_early) json["ends_early"] = true;
        json["errors"] = Json::array();
        for (const ReadingError& error : reading.errors)
            json["errors"].push_back({{"line", error.line},
                                      {"file", error.file},
                                      {"rule", error.finding.rule},
                                      {"message", error.finding.message}});
        if (reading.stopped) json["stopped"] = error_json(*reading.stopped);
        json["cure"] = reading.cure();
        all.push_back(std::move(json));
    }
    return all;
}

Json statistics_json(const CheckRun& run) {
    Json json;
    json["points"] = run.points;
    json["lines"] = run.lines;
    json["sphere_tests"] = 0; // this engine tests boxes and exact shapes instead
    json["point_tests"] = 0;
    json["model_bytes"] = run.memory;
    json["box_tests"] = run.statistics.box_tests;
    json["shape_tests"] = run.statistics.shape_tests;
    json["refined"] = run.statistics.refined;
    json["sweeps"] = run.statistics.sweeps;
    json["removed"] = run.removed;
    json["duration"] = run.cycle_time;
    json["seconds"] = {
        {"read", run.times.read}, {"model", run.times.model}, {"check", run.times.check}};
    return json;
}

Json part_json(const CheckRun& run) {
    const core::PartComparison& comparison = *run.comparison;
    Json json;
    json["tolerance"] = run.setup.part->tolerance;
    if (run.setup.part->deviation > 0.0) json["deviation"] = run.setup.part->deviation;
    json["largest_gouge"] = comparison.largest_gouge;
    json["largest_excess"] = comparison.largest_excess;
    json["between_samples"] = comparison.between_samples;
    json["samples"] = comparison.samples;
    json["regions"] = Json::array();
    for (const core::DeviationRegion& region : comparison.regions) {
        Json entry;
        entry["kind"] = core::name_of(region.kind);
        entry["amount"] = region.amount;
        entry["at"] = array_of(region.position);
        entry["area"] = region.area;
        entry["block"] = region.block ? Json(*region.block) : Json(nullptr);
        entry["line"] = region.block ? Json(run.blocks.line(*region.block)) : Json(nullptr);
        json["regions"].push_back(std::move(entry));
    }
    return json;
}

Json saved_json(const SavedStock& saved) {
    if (saved.triangles == 0) return {{"file", saved.file}, {"moves", saved.moves}};
    return {{"file", saved.file},
            {"triangles", saved.triangles},
            {"error", saved.error},
            {"lost_points", saved.lost}};
}

/// Facts about the program as a whole, written before its blocks.
Json heading_json(const CheckRun& run) {
    Json json;
    json["feeler"] = version;
    json["schema"] = 1;
    json["program"] = {{"file", run.program_file},
                       {"sha256", run.sha256},
                       {"dialect", gcode::dialect(run.dialect).name},
                       {"blocks", run.blocks.size()}};
    json["engine"] = name_of(run.engine);
    json["allowance"] = run.setup.allowance ? Json(*run.setup.allowance) : Json(nullptr);
    json["mesh_size"] = run.setup.mesh_size;
    json["assumptions"] = run.all_assumptions();
    json["verdict"] = core::name_of(run.verdict);
    json["headline"] = run.headline();
    json["coverage"] = json_of(run.full_coverage());
    json["cycle_time"] = run.cycle_time;
    if (run.stopped) json["error"] = error_json(*run.stopped);
    return json;
}

Json limit_json(const ToleranceLimit& limit) {
    Json json;
    json["by"] = limit.by;
    json["or_more"] = limit.is_open;
    json["not_shown"] = limit.not_shown ? Json(*limit.not_shown) : Json(nullptr);
    json["line"] = limit.line > 0 ? Json(limit.line) : Json(nullptr);
    if (!limit.file.empty()) json["file"] = limit.file;
    json["tool"] = limit.tool ? Json(core::value_of(*limit.tool)) : Json(nullptr);
    json["pair"] = limit.pair[0].empty() ? Json(nullptr) : Json(limit.pair);
    return json;
}

Json tolerance_json(const Tolerance& tolerance) {
    const Deviation& deviation = tolerance.deviation;
    Json json;
    json["quantity"] = name_of(deviation.quantity);
    json["of"] = deviation.subject();
    json["axis"] =
        deviation.is_place() ? Json(std::string(1, "XYZ"[deviation.axis])) : Json(nullptr);
    json["text"] = range_text(tolerance);
    if (!tolerance.not_studied.empty()) json["not_studied"] = tolerance.not_studied;
    if (!tolerance.unknown.empty()) json["unknown"] = tolerance.unknown;
    if (!tolerance.is_known()) return json;
    json["less"] = limit_json(tolerance.less);
    json["more"] = limit_json(tolerance.more);
    return json;
}

Json tolerances_json(const Tolerances& tolerances) {
    Json json;
    json["refusal"] = tolerances.refusal.empty() ? Json(nullptr) : Json(tolerances.refusal);
    json["list"] = Json::array();
    for (const Tolerance& tolerance : tolerances.list)
        json["list"].push_back(tolerance_json(tolerance));
    json["runs"] = tolerances.runs;
    json["work"] = tolerances.work;
    json["seconds"] = tolerances.seconds;
    return json;
}

/// Part, saved stock, tolerances and statistics, written after blocks and findings.
void add_ending(Json& json, const CheckRun& run) {
    if (!run.readings.empty()) json["readings"] = readings_json(run);
    if (run.comparison) json["part"] = part_json(run);
    if (run.saved_stock) json["saved_stock"] = saved_json(*run.saved_stock);
    if (run.tolerances) json["tolerances"] = tolerances_json(*run.tolerances);
    json["statistics"] = statistics_json(run);
}

std::string line_text(const Json& json) { return json_text(json) + "\n"; }

Json record(const char* name, Json values) {
    Json json = {{"record", name}};
    json.update(values);
    return json;
}

} // namespace

namespace {

/// The members of an object, without its braces, as they are in an object that is not within
/// another.
std::string members_text(const Json& json) {
    const std::string text = json_text(json, 1); // "{\n members\n}"
    return text.substr(1, text.size() - 3);
}

/// An object as an entry of a list that is a member of the outermost object.
std::string entry_text(const Json& json) {
    std::string entry = "\n  ";
    for (const char letter : json_text(json, 1)) { // no text within has a line end
        entry += letter;
        if (letter == '\n') entry += "  ";
    }
    return entry;
}

/// Writes a list of objects, one at a time, as a member of the outermost object.
class ListWriter {
public:
    ListWriter(std::string_view name, const TextSink& out) : out_(out) {
        out_(fmt::format(",\n \"{}\": [", name));
    }
    void add(const Json& json) {
        if (std::exchange(is_empty_, false))
            out_(entry_text(json));
        else
            out_("," + entry_text(json));
    }
    void end() { out_(is_empty_ ? "]" : "\n ]"); }

private:
    const TextSink& out_;
    bool is_empty_ = true;
};

} // namespace

void json_report(const CheckRun& run, bool pairs, const TextSink& out) {
    out("{" + members_text(heading_json(run)));
    const RulesByBlock rules = rules_of_blocks(run);
    ListWriter blocks("blocks", out);
    for (const CheckedBlock& block : run.blocks)
        blocks.add(block_json(run, block, rules_of(block.block, rules), pairs));
    blocks.end();
    ListWriter findings("findings", out);
    for (const core::Finding& finding : run.findings) findings.add(finding_json(run, finding));
    findings.end();
    Json ending = Json::object();
    add_ending(ending, run);
    out("," + members_text(ending) + "\n}\n");
}

std::string json_report(const CheckRun& run, bool pairs) {
    return text_of([&](const TextSink& out) { json_report(run, pairs, out); });
}

void json_lines_report(const CheckRun& run, bool pairs, const TextSink& out) {
    out(line_text(record("program", heading_json(run))));
    const RulesByBlock rules = rules_of_blocks(run);
    for (const CheckedBlock& block : run.blocks)
        out(line_text(
            record("block", block_json(run, block, rules_of(block.block, rules), pairs))));
    for (const core::Finding& finding : run.findings)
        out(line_text(record("finding", finding_json(run, finding))));
    Json ending = {{"record", "end"}, {"verdict", core::name_of(run.verdict)}};
    if (run.stopped) ending["error"] = error_json(*run.stopped);
    add_ending(ending, run);
    out(line_text(ending));
}

std::string json_lines_report(const CheckRun& run, bool pairs) {
    return text_of([&](const TextSink& out) { json_lines_report(run, pairs, out); });
}

RulesByBlock rules_of_blocks(const CheckRun& run) {
    std::vector<const core::Finding*> all;
    for (const auto* findings : {&run.findings, &run.combined_findings})
        for (const core::Finding& finding : *findings)
            if (finding.block) all.push_back(&finding);
    std::stable_sort(all.begin(), all.end(),
                     [](const auto* a, const auto* b) { return a->severity > b->severity; });
    RulesByBlock rules;
    for (const core::Finding* finding : all) {
        std::vector<std::string>& some = rules[*finding->block];
        if (std::find(some.begin(), some.end(), finding->rule) == some.end())
            some.push_back(finding->rule);
    }
    return rules;
}

const std::vector<std::string>& rules_of(core::BlockIndex block, const RulesByBlock& rules) {
    static const std::vector<std::string> none;
    const auto found = rules.find(block);
    return found == rules.end() ? none : found->second;
}

} // namespace app

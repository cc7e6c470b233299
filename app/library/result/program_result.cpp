#include "app/library/result/program_result.h"

#include <algorithm>
#include <stdexcept>

#include "app/base/findings.h"
#include "app/base/sha256.h"
#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/library/result/stored_json.h"
#include "core/base/file_reads.h"
#include "gcode/language/dialect.h"
#include "gcode/text/program_text.h"

namespace app {
namespace {

using Json = StoredJson;

/// The column in characters, as in editors and SARIF; in bytes if the line cannot be read.
uint32_t column_of(const core::Error& error) {
    const auto [line, column, length] = error.where;
    if (column <= 1 || line == 0 || !core::is_file(error.file)) return column;
    const std::string bytes = core::file_bytes(error.file).value_or("");
    std::string_view text = bytes;
    if (text.starts_with(gcode::byte_order_mark)) text.remove_prefix(gcode::byte_order_mark.size());
    const std::vector<uint32_t> starts = gcode::starts_of_lines(text);
    if (line > starts.size() || starts[line - 1] + column - 1 > text.size()) return column;
    return static_cast<uint32_t>(characters_in(text.substr(starts[line - 1], column - 1))) + 1;
}

StoredError stored(const core::Error& error, FileBytes& bytes) {
    return {shown_name(error.file, bytes), error.where.line, column_of(error),
            utf8_text(error.message)};
}

StoredFinding stored(const core::Finding& finding, const CheckRun& run, FileBytes& bytes) {
    StoredFinding made{finding};
    made.message = utf8_text(finding.message);
    made.cure = utf8_text(finding.cure);
    made.pair = {utf8_text(finding.pair[0]), utf8_text(finding.pair[1])};
    if (!finding.block) return made;
    const CheckedBlock block = run.blocks[core::value_of(*finding.block)];
    made.line = block.line;
    made.file = shown_name(block.file, bytes);
    made.text = utf8_text(block.text);
    return made;
}

std::optional<Tightest> tightest_of(const CheckRun& run) {
    const auto nearest = tightest_block(run);
    if (!nearest) return {};
    const core::PairClearance& pair = nearest->result.pairs[*nearest->result.deciding];
    Tightest tightest{.block = core::value_of(nearest->block),
                      .line = nearest->line,
                      .pair = {utf8_text(core::part_name(run.setup, pair.pair)),
                               utf8_text(core::body_name(run.setup, pair.pair))},
                      .lower = pair.lower,
                      .allowance = pair.allowance.distance};
    if (pair.found()) tightest.upper = pair.upper;
    return tightest;
}

/// Adds the depth of a finding's overlap, if it was measured.
void add_overlap(Json& json, const StoredFinding& finding) {
    if (!finding.overlap) return;
    const core::Overlap& overlap = *finding.overlap;
    json["depth"] = {{"least", overlap.least},
                     {"most", overlap.most ? Json(*overlap.most) : Json(nullptr)}};
    const core::Vec3& way = overlap.way_out;
    json["way_out"] = overlap.most ? Json::array({way.x, way.y, way.z}) : Json(nullptr);
}

std::optional<core::Overlap> overlap_from(const Json& json) {
    if (!json.contains("depth")) return {};
    core::Overlap overlap{.least = number_from(json.at("depth").at("least"))};
    if (const Json& most = json.at("depth").at("most"); !most.is_null()) {
        overlap.most = number_from(most);
        for (int axis = 0; axis < 3; ++axis)
            overlap.way_out[axis] =
                number_from(json.at("way_out").at(static_cast<size_t>(axis)), -1.0);
    }
    return overlap;
}

Json json_of(const StoredFinding& finding) {
    Json json = {{"rule", finding.rule},
                 {"severity", core::name_of(finding.severity)},
                 {"block", finding.block ? Json(core::value_of(*finding.block)) : Json(nullptr)},
                 {"line", finding.line},
                 {"file", finding.file},
                 {"text", finding.text},
                 {"message", finding.message},
                 {"cure", finding.cure},
                 {"pair", finding.pair},
                 {"shortfall", finding.shortfall}};
    add_overlap(json, finding);
    return json;
}

Json json_of(const Tightest& tightest) {
    return {{"block", tightest.block},
            {"line", tightest.line},
            {"pair", tightest.pair},
            {"lower", tightest.lower},
            {"upper", tightest.upper ? Json(*tightest.upper) : Json(nullptr)},
            {"allowance", tightest.allowance}};
}

Json json_of(const StoredError& error) {
    return {{"file", error.file},
            {"line", error.line},
            {"column", error.column},
            {"message", error.message}};
}

/// The value of an enumeration with this name; throws if there is none, as JSON readers do.
template <typename Enum, size_t count>
Enum named_as(const std::string& name) {
    for (size_t i = 0; i < count; ++i)
        if (name == core::name_of(static_cast<Enum>(i))) return static_cast<Enum>(i);
    throw std::invalid_argument("unknown value " + name);
}

StoredError error_from(const Json& json) {
    return {json.at("file"), whole_from<uint32_t>(json.at("line")),
            whole_from<uint32_t>(json.at("column")), json.at("message")};
}

StoredFinding finding_from(const Json& json) {
    StoredFinding finding{{.rule = json.at("rule"),
                           .severity = named_as<core::Severity, 4>(json.at("severity")),
                           .message = json.at("message"),
                           .cure = json.at("cure"),
                           .pair = pair_from(json.at("pair")),
                           .shortfall = number_from(json.at("shortfall"))},
                          whole_from<uint32_t>(json.at("line")),
                          json.at("file"),
                          json.at("text")};
    if (const Json& block = json.at("block"); !block.is_null())
        finding.block = core::BlockIndex{whole_from<uint32_t>(block)};
    finding.overlap = overlap_from(json);
    return finding;
}

Tightest tightest_from(const Json& json) {
    Tightest tightest{.block = whole_from<uint32_t>(json.at("block")),
                      .line = whole_from<uint32_t>(json.at("line")),
                      .pair = pair_from(json.at("pair")),
                      .lower = number_from(json.at("lower")),
                      .allowance = number_from(json.at("allowance"))};
    if (const Json& upper = json.at("upper"); !upper.is_null()) tightest.upper = number_from(upper);
    return tightest;
}

ProgramResult result_from(const Json& json) {
    ProgramResult result{.program = json.at("program"),
                         .setup = json.at("setup"),
                         .sha256 = json.at("sha256"),
                         .dialect = json.at("dialect"),
                         .engine = json.at("engine"),
                         .verdict = named_as<core::Verdict, 4>(json.at("verdict")),
                         .assumptions = list_from(json.at("assumptions")),
                         .blocks = whole_from<size_t>(json.at("blocks")),
                         .cycle_time = number_from(json.at("cycle_time"), 0.0),
                         .removed = number_from(json.at("removed")),
                         .seconds = number_from(json.at("seconds"), 0.0)};
    if (json.contains("coverage") && !json.at("coverage").is_null())
        result.coverage = coverage_from(json.at("coverage"));
    if (const Json& error = json.at("error"); !error.is_null()) result.error = error_from(error);
    if (const Json& tightest = json.at("tightest"); !tightest.is_null())
        result.tightest = tightest_from(tightest);
    for (const Json& finding : list_from(json.at("findings")))
        result.findings.push_back(finding_from(finding));
    if (json.contains("file_bytes")) result.file_bytes = file_bytes_from(json.at("file_bytes"));
    return result;
}

} // namespace

ProgramResult result_of(const CheckRun& run, const std::string& setup) {
    FileBytes bytes;
    ProgramResult result{.program = shown_name(run.program_file, bytes),
                         .setup = shown_name(setup, bytes),
                         .sha256 = run.sha256,
                         .dialect = std::string(gcode::dialect(run.dialect).name),
                         .engine = name_of(run.engine),
                         .verdict = run.verdict,
                         .coverage = run.full_coverage(),
                         .blocks = run.blocks.size(),
                         .cycle_time = run.cycle_time,
                         .removed = run.removed,
                         .tightest = tightest_of(run),
                         .seconds = run.times.read + run.times.model + run.times.check};
    if (run.stopped) result.error = stored(*run.stopped, bytes);
    for (const std::string& assumption : run.all_assumptions())
        result.assumptions.push_back(utf8_text(assumption));
    for (const core::Finding& finding : run.findings)
        result.findings.push_back(stored(finding, run, bytes));
    result.file_bytes = std::move(bytes);
    return result;
}

ProgramResult failed_result(const CheckJob& job, const core::Error& error) {
    FileBytes bytes;
    ProgramResult result{.program = shown_name(job.program, bytes),
                         .setup = shown_name(job.setup, bytes),
                         .sha256 = sha256_of_file(job.program),
                         .engine = name_of(job.engine),
                         .error = stored(error, bytes)};
    result.file_bytes = std::move(bytes);
    return result;
}

bool has_only_contact(const ProgramResult& result) {
    return result.verdict == core::Verdict::clear && result.tightest
           && result.tightest->allowance <= core::resolution
           && result.tightest->lower <= core::resolution;
}

int status_of(const ProgramResult& result) {
    if (result.error) return 2;
    const bool has_errors = std::any_of(
        result.findings.begin(), result.findings.end(),
        [](const StoredFinding& finding) { return finding.severity == core::Severity::error; });
    return has_errors ? 1 : 0;
}

std::string headline_of(const ProgramResult& result) {
    const bool in_program =
        std::any_of(result.findings.begin(), result.findings.end(), is_error_of_program);
    Coverage unknown;
    unknown.moves = result.blocks > 0;
    return headline_of({.verdict = result.verdict,
                        .is_stopped = result.error.has_value(),
                        .has_errors = in_program,
                        .lacks_required = std::any_of(result.findings.begin(),
                                                      result.findings.end(), lacks_coverage)},
                       result.coverage.value_or(unknown));
}

std::string uncovered_text(const ProgramResult& result) {
    if (result.coverage) return uncovered_text(*result.coverage);
    return result.blocks == 0 ? "" : "unknown: checked by an older version of Feeler";
}

std::string json_of(const ProgramResult& result) {
    Json json = {{"program", result.program},
                 {"setup", result.setup},
                 {"sha256", result.sha256},
                 {"dialect", result.dialect},
                 {"engine", result.engine},
                 {"verdict", core::name_of(result.verdict)},
                 {"headline", headline_of(result)},
                 {"coverage", result.coverage ? json_of(*result.coverage) : Json(nullptr)},
                 {"error", result.error ? json_of(*result.error) : Json(nullptr)},
                 {"blocks", result.blocks},
                 {"cycle_time", result.cycle_time},
                 {"removed", result.removed},
                 {"tightest", result.tightest ? json_of(*result.tightest) : Json(nullptr)},
                 {"seconds", result.seconds},
                 {"assumptions", result.assumptions},
                 {"findings", Json::array()}};
    for (const StoredFinding& finding : result.findings)
        json["findings"].push_back(json_of(finding));
    if (!result.file_bytes.empty()) json["file_bytes"] = json_of(result.file_bytes);
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

core::Result<ProgramResult> result_from_json(const std::string& text) {
    try {
        return result_from(parsed_stored_json(text));
    } catch (const std::exception& wrong) {
        return core::fail(core::ErrorCode::syntax,
                          std::string("this is not the result of a check: ") + wrong.what());
    }
}

std::string shown_name(const std::string& path, FileBytes& bytes) {
    std::string text = utf8_text(path);
    if (text != path) bytes[text] = path;
    return text;
}

const std::string& name_shown_as(const std::string& text, const FileBytes& bytes) {
    const auto found = bytes.find(text);
    return found == bytes.end() ? text : found->second;
}

} // namespace app

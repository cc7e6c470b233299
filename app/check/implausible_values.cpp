#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "app/check/conclusion.h"
#include "app/check/prepared_check.h"
#include "app/check/run_state.h"
#include "app/check/tool_mismatch.h"
#include "app/check/unit_doubt.h"
#include "app/setup/tools/program_tools.h"
#include "core/base/rule_table.h"
#include "core/base/text.h"
#include "core/sim/setup.h"
#include "gcode/language/dialect.h"
#include "gcode/text/source.h"

namespace app {
namespace {

// Limits that leave room above the largest machines and tools on the market. Whatever exceeds one
// of them is a wrong number or a wrong unit.
constexpr double most_feed = 100e3;       // mm/min; linear motors reach 60 to 120 m/min in rapids
constexpr double most_speed = 400e3;      // rev/min; air turbines for micro-drills reach 300,000
constexpr double most_edge_speed = 10e3;  // m/min; aluminium is cut at up to 7,000
constexpr double most_diameter = 500.0;   // mm; face mills end at 400
constexpr double most_drill = 250.0;      // mm; indexable and spade drills end at 200
constexpr double most_length = 1500.0;    // mm, tip to gauge line; long boring bars reach 1,000
constexpr double most_travel = 30e3;      // mm, X and Y; large gantry mills
constexpr double most_height = 3000.0;    // mm, Z; rams of large gantry mills travel 2,000
constexpr double most_rate = 30e6;        // mm3/min; the best spindles take 10 to 15 l/min
constexpr double least_rate_volume = 1e4; // mm3; below that, rounding decides the rate
constexpr double most_volume = 2e9;       // mm3; 5 t of aluminium

class Findings {
public:
    explicit Findings(const core::Setup& setup) : setup_(setup) {}

    void add(std::optional<core::BlockIndex> block, std::string message, std::string cure,
             core::Severity most = core::Severity::error) {
        core::Finding finding;
        finding.rule = core::rule_id("implausible-value");
        finding.severity = std::min(core::severity_of(setup_, finding.rule), most);
        finding.block = block;
        finding.message = std::move(message);
        finding.cure = std::move(cure);
        if (finding.severity != core::Severity::off) found.push_back(std::move(finding));
    }

    std::vector<core::Finding> found;

private:
    const core::Setup& setup_;
};

void check_feed(Findings& findings, const FeedFacts& facts) {
    if (facts.fastest && facts.fastest->value > most_feed)
        findings.add(facts.fastest->block,
                     fmt::format("The feed is {:.0f} mm/min; no machine feeds faster than {:.0f}.",
                                 facts.fastest->value, most_feed),
                     "Check F for a missing decimal point, its unit, and G94 or G95.");
    else if (facts.too_fast)
        findings.add(facts.too_fast->block,
                     fmt::format("The feed is {:.0f} mm/min, but the rapid speeds of the axes in "
                                 "the set-up allow {:.0f} mm/min on this path.",
                                 facts.too_fast->value, facts.possible),
                     "Check F and its unit, and `rapid` of the axes in the set-up.",
                     core::Severity::warning);
}

void check_spindle(Findings& findings, const FeedFacts& facts) {
    if (facts.speed && facts.speed->value > most_speed)
        findings.add(facts.speed->block,
                     fmt::format("The spindle turns at {:.0f} rev/min; no spindle turns faster "
                                 "than {:.0f}.",
                                 facts.speed->value, most_speed),
                     "Check S.");
    else if (facts.edge_speed && facts.edge_speed->value > most_edge_speed)
        findings.add(facts.edge_speed->block,
                     fmt::format("The edge of the tool moves at {:.0f} m/min; no tool is run "
                                 "faster than at {:.0f}.",
                                 facts.edge_speed->value, most_edge_speed),
                     "Check S, and the diameter of the tool and its unit.");
}

void check_tools(Findings& findings, const FeedFacts& facts, const core::Setup& setup) {
    for (const auto& [number, block] : facts.tools) {
        const auto found = setup.tools.find(number);
        if (found == setup.tools.end()) continue;
        const core::ToolDescription& tool = found->second.description;
        const bool drills = core::only_drills(tool.shape);
        const double most = drills ? most_drill : most_diameter;
        const double length =
            std::max(tool.stick_out.value_or(0.0), tool.gauge_length.value_or(0.0));
        if (tool.diameter > most)
            findings.add(
                block,
                fmt::format("Tool {} is {} of {:g} mm; there is none of more than {:g} mm.",
                            core::value_of(number), core::description_of(tool.shape), tool.diameter,
                            most),
                "Check the unit of the program, and the diameter in the set-up or in the "
                "comment of the program.");
        else if (length > most_length)
            findings.add(block,
                         fmt::format("Tool {} is {:g} mm long; there is none of more than {:g} mm.",
                                     core::value_of(number), length, most_length),
                         "Check the lengths of the tool and their unit.");
    }
}

void check_distances(Findings& findings, const FeedFacts& facts) {
    if (!facts.first) return;
    const core::Vec3 size = facts.box.size();
    const double longest = std::max(size.x, size.y);
    const bool high = size.z > most_height;
    if (longest <= most_travel && !high) return;
    findings.add(facts.first,
                 fmt::format("The feeds of the program span {:.1f} m in {}; no machine is that "
                             "large.",
                             (high ? size.z : longest) / 1000.0, high ? "Z" : "X or Y"),
                 "Check for missing decimal points, and the unit of the program.");
}

/// The first block that removes material faster than any machine can.
std::optional<CheckedBlock> too_greedy(const CheckRecord& record) {
    constexpr double seconds = 60.0;
    const auto is_greedy = [](const CheckedBlock& block) {
        const core::BlockResult& result = block.result;
        const bool feeds =
            result.motion != core::BlockMotion::none && result.motion != core::BlockMotion::rapid;
        return feeds && result.removed > least_rate_volume
               && result.removed * seconds > most_rate * result.duration;
    };
    for (const CheckedBlock& block : record.blocks.without_texts())
        if (is_greedy(block)) return block;
    return std::nullopt;
}

void check_volume(Findings& findings, const CheckRecord& record) {
    constexpr double litre = 1e6, minute = 60.0;
    if (const auto block = too_greedy(record)) {
        const double rate = block->result.removed / block->result.duration * minute / litre;
        findings.add(block->block,
                     fmt::format("This block removes {:.1f} litres of material at {:.0f} l/min; no "
                                 "machine removes more than {:.0f} l/min.",
                                 block->result.removed / litre, rate, most_rate / litre),
                     "Check the feed, the depth, the tool's diameter and their units.");
    } else if (record.removed > most_volume) {
        findings.add(
            std::nullopt,
            fmt::format("The program removes {:.1f} m3 of material.", record.removed / 1e9),
            "Check the size of the stock, and the unit of the program.");
    }
}

/// Findings about values beyond what machines have.
std::vector<core::Finding> implausible_values(const FeedFacts& facts, const CheckRecord& record,
                                              const core::Setup& setup) {
    Findings findings(setup);
    check_feed(findings, facts);
    check_spindle(findings, facts);
    check_tools(findings, facts, setup);
    check_distances(findings, facts);
    check_volume(findings, record);
    return std::move(findings.found);
}

/// Whether a line of code, in capitals and without blanks, begins or ends a subprogram.
bool is_of_subprogram(const std::string& code) {
    if (code.starts_with('O') && code.ends_with("SUB")) return true;
    if (code.find("PROC") != std::string::npos) return true;
    for (const char* end : {"M99", "M17", "RET"})
        if (code.ends_with(end)) return true;
    return false;
}

bool defines_subprogram(const gcode::Program& program) {
    if (core::lower_case(program.file).ends_with(".spf")) return true; // Siemens
    for (size_t line = 1; line <= program.line_count(); ++line)
        if (is_of_subprogram(parts_of_line(program.line(line)).code)) return true;
    return false;
}

std::optional<core::Finding> nothing_moves(const CheckRecord& record, const FeedFacts& facts,
                                           const core::Setup& setup,
                                           const gcode::Program& program) {
    if (record.stopped || facts.moves) return std::nullopt;
    core::Finding finding;
    finding.rule = core::rule_id("nothing-moves");
    finding.severity = core::severity_of(setup, finding.rule);
    finding.message = "The program moves no axis, so nothing was checked.";
    finding.cure = "Check whether this is the right file, and the whole file.";
    if (defines_subprogram(program)) {
        finding.severity = std::min(finding.severity, core::Severity::warning);
        finding.message = "The program only defines subprograms and moves no axis by itself, so "
                          "nothing was checked.";
        finding.cure = "Check a program that calls them.";
    }
    if (finding.severity == core::Severity::off) return std::nullopt;
    return finding;
}

/// The finding `offset-implausible`: the program's own stock reaches beyond that of the set-up.
/// Nothing if another finding of the rule says that the work offset is wrong.
std::optional<core::Finding> stock_mismatch(const SetupFile& file, const CheckRecord& record,
                                            const core::Setup& setup) {
    core::Finding finding;
    finding.rule = core::rule_id("offset-implausible");
    const bool is_known =
        std::any_of(record.findings.begin(), record.findings.end(),
                    [&](const core::Finding& other) { return other.rule == finding.rule; });
    if (file.stock_mismatch.empty() || is_known) return std::nullopt;
    finding.severity = core::severity_of(setup, finding.rule);
    finding.message = file.stock_mismatch;
    finding.cure = "Clamp the stock that the program was made for, or correct [stock] or the work "
                   "offset in the set-up.";
    if (finding.severity == core::Severity::off) return std::nullopt;
    return finding;
}

} // namespace

std::vector<core::Finding> implausible_findings(const PreparedCheck& check,
                                                const CheckRecord& record, const RunState& end,
                                                const core::Setup& setup) {
    std::vector<core::Finding> findings;
    const auto add = [&](std::optional<core::Finding> finding) {
        if (finding) findings.push_back(*std::move(finding));
    };
    add(nothing_moves(record, end.feeds, setup, *check.program));
    const bool unit_said = end.control.modal.unit_said;
    std::optional<core::Aabb> stock;
    if (check.stock_is_stated) stock = end.machine.stock.outer_box;
    if (stock) add(unit_mismatch(end.feeds, setup, *stock, unit_said));
    if (stock) add(stock_mismatch(check.file, record, setup));
    if (!check.file.not_judged.empty()) return findings;
    for (core::Finding& value : implausible_values(end.feeds, record, setup)) add(std::move(value));
    for (core::Finding& tool : findings_of(check.tool_mismatches, end.feeds, setup))
        add(std::move(tool));
    add(units_doubtful(*check.program, end.feeds, setup, stock, unit_said,
                       check.file.environment.dialect == gcode::DialectId::siemens
                           ? UnitCodes{"G71 or G710", "G70 or G700"}
                           : UnitCodes{},
                       end.offsets));
    return findings;
}

} // namespace app

#include "app/check/conclusion.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "app/check/check_run.h"
#include "app/check/length_mismatch.h"
#include "app/check/over_travel.h"
#include "app/check/prepared_check.h"
#include "app/check/stock_file.h"
#include "app/setup/coverage.h"
#include "app/setup/inference/program_survey.h"
#include "core/base/rule_table.h"
#include "core/base/text.h"
#include "core/dbm/stock_mesh.h"
#include "core/geom/mesh.h"
#include "core/sim/part_comparison.h"
#include "core/sim/run/finding_text.h"
#include "core/sim/run/simulator.h"
#include "core/sim/verdict.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"
#include "gcode/text/source.h"

namespace app {
namespace {

/// Reports a program of which no motion could be judged: it has not been checked.
void require_judged_motion(CheckRecord& record) {
    std::optional<core::BlockIndex> first;
    for (const CheckedBlock& block : record.blocks) {
        if (block.result.motion == core::BlockMotion::none) continue;
        if (block.result.checked) return;
        if (!first) first = block.block;
    }
    if (!first) return;
    core::Finding finding;
    finding.rule = core::rule_id("undecided");
    finding.severity = core::Severity::error;
    finding.block = first;
    finding.message = "No motion of the program could be checked.";
    const bool is_lost =
        std::any_of(record.findings.begin(), record.findings.end(),
                    [](const auto& f) { return f.rule == core::rule_id("first-move"); });
    finding.cure = !is_lost ? "Correct the other findings first."
                            : "State the axis positions at the first block: `start` under "
                              "[program] in the set-up, or the machine's home position.";
    record.findings.push_back(finding);
}

/// Reports motions that were not checked, so that the program does not count as checked.
void report_not_judged(CheckRecord& record, const std::string& why) {
    const auto moves = [](const CheckedBlock& block) {
        return block.result.motion != core::BlockMotion::none;
    };
    if (why.empty() || std::none_of(record.blocks.begin(), record.blocks.end(), moves)) return;
    core::Finding finding;
    finding.rule = core::rule_id("undecided");
    finding.severity = core::Severity::error;
    finding.message = "The motions were not checked: " + why + ".";
    finding.cure = "Check the program on the lathe's own control.";
    record.verdict = std::max(record.verdict, core::Verdict::undecided);
    record.findings.push_back(finding);
}

/// Reports what the set-up does not describe, if the rule is on.
void report_incomplete_setup(const CheckRun& run, CheckRecord& record) {
    core::Finding finding;
    finding.rule = core::rule_id("incomplete-setup");
    finding.severity = core::severity_of(run.setup, finding.rule);
    const Coverage coverage = run.full_coverage();
    if (coverage.is_complete() || finding.severity == core::Severity::off) return;
    finding.message = "Not everything was checked: " + uncovered_text(coverage) + ".";
    finding.cure = "Describe it in the set-up";
    if (coverage.fixtures == Known::missing)
        finding.cure += "; if there are no fixtures, write fixtures = \"none\" at its top";
    if (coverage.limits_need_offsets)
        finding.cure += "; the axis limits are checked once [offsets] states the work offsets";
    finding.cure += ".";
    record.findings.push_back(finding);
}

/// Sorts findings by block, those about the whole program last.
void put_in_order(std::vector<core::Finding>& findings) {
    std::stable_sort(findings.begin(), findings.end(), [](const auto& a, const auto& b) {
        if (!a.block || !b.block) return a.block.has_value() && !b.block;
        return core::value_of(*a.block) < core::value_of(*b.block);
    });
}

/// Makes findings in a block that could not be run, the first one after --start-line, findings
/// about the whole program.
void take_from_missing_blocks(CheckRun& run) {
    for (core::Finding& finding : run.findings)
        if (finding.block && core::value_of(*finding.block) >= run.blocks.size())
            finding.block.reset();
}

} // namespace

void conclude(PreparedCheck& check, const core::SimulatorState& end,
              const std::vector<LengthMismatch>& mismatches, bool needs_surface) {
    CheckRun& run = check.run;
    run.statistics = end.statistics;
    run.points = core::point_count(end.stock.lines);
    run.lines = core::line_count(end.stock.lines);
    run.later_assumptions.insert(run.later_assumptions.end(), end.assumptions.begin(),
                                 end.assumptions.end());
    require_judged_motion(run);
    report_incomplete_setup(run, run);
    // A program that was checked only in part must not count as clear.
    if (run.stopped) run.verdict = std::max(run.verdict, core::Verdict::undecided);
    take_from_missing_blocks(run);
    put_in_order(run.findings);
    report_not_judged(run, check.file.not_judged);
    run.stock = std::make_shared<const core::CutModel>(end.stock);
    run.stock_error = end.corners.of_stock();
    if (!run.stopped && (needs_surface || run.setup.part))
        run.surface = std::make_shared<const core::StockMesh>(core::stock_mesh(*run.stock));
    check_part(run, run, run);
    check_both_switch_positions(run, run, *check.program, check.file.environment);
    apply_allowed_rules(run, run, check.file.allow_comments);
    combine_consequences(run, run, mismatches);
    combine_over_travels(run, run);
}

namespace {

/// "line 7", "lines 7, 9, 12".
std::string lines_text(const std::vector<uint32_t>& lines) {
    std::string text;
    for (const uint32_t line : lines) text += (text.empty() ? "" : ", ") + std::to_string(line);
    return (lines.size() == 1 ? "line " : "lines ") + text;
}

/// Removes a word from the front of a text, after blanks. Whether it was there.
bool take(std::string_view& text, std::string_view word) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    if (text.substr(0, word.size()) != word) return false;
    text.remove_prefix(word.size());
    return true;
}

bool comes_of_a_collision(const CheckInput& input, const CheckRecord& record,
                          const core::Finding& finding) {
    if (finding.rule == core::rule_id("collision")) return true;
    const auto collides = [&](const ReadingResult& reading) {
        return reading.block == *finding.block
               && (reading.verdict == core::Verdict::collision || reading.ends_early);
    };
    if (finding.rule == core::rule_id("open-premise")
        && std::any_of(record.readings.begin(), record.readings.end(), collides))
        return true;
    const core::BlockResult block = record.blocks[core::value_of(*finding.block)].result;
    return std::any_of(block.pairs.begin(), block.pairs.end(),
                       [&](const core::PairClearance& pair) {
                           return pair.verdict == core::Verdict::collision
                                  && core::part_name(input.setup, pair.pair) == finding.pair[0]
                                  && core::body_name(input.setup, pair.pair) == finding.pair[1];
                       });
}

bool is_allowed(const CheckRecord& record, const core::Finding& finding) {
    if (!finding.block) return false;
    const std::string text = record.blocks[core::value_of(*finding.block)].text;
    if (text.find_first_of("(;") == std::string::npos) return false;
    const std::vector<AllowedRule> rules = allowed_rules(text);
    return std::any_of(rules.begin(), rules.end(),
                       [&](const AllowedRule& rule) { return rule.name == finding.rule; });
}

core::Finding about_comment(const CheckedBlock& block, const AllowedRule& rule,
                            core::Severity severity) {
    core::Finding finding;
    finding.rule = core::rule_id("program");
    finding.severity = severity;
    finding.block = block.block;
    finding.message = fmt::format("Line {}, column {}: the comment allows {}", block.line,
                                  rule.column, rule.name);
    return finding;
}

/// The finding for an invalid name in a comment; empty if the name is valid.
std::optional<core::Finding> doubt_about(const CheckedBlock& block, const AllowedRule& rule,
                                         bool comments_count) {
    if (!core::default_severity(rule.name)) {
        core::Finding finding = about_comment(block, rule, core::Severity::warning);
        finding.message += ", but there is no such rule; the comment has no effect.";
        finding.cure =
            fmt::format("Write {} if you mean that rule.", core::nearest_rule(rule.name));
        return finding;
    }
    if (comments_count) return std::nullopt;
    core::Finding finding = about_comment(block, rule, core::Severity::note);
    finding.message += ", but the set-up does not permit that; the comment has no effect.";
    finding.cure = "Set allow_comments = true under [rules] to permit such comments.";
    return finding;
}

/// Checks every comment of the executed lines once.
void report_invalid_comments(const CheckInput& input, CheckRecord& record, bool comments_count) {
    std::set<std::pair<std::string, uint32_t>> seen;
    std::vector<core::Finding> found;
    for (const CheckedBlock& block : record.blocks) {
        if (block.text.find_first_of("(;") == std::string::npos) continue;
        if (!seen.emplace(block.file, block.line).second) continue;
        for (const AllowedRule& rule : allowed_rules(block.text))
            if (auto doubt = doubt_about(block, rule, comments_count))
                found.push_back(*std::move(doubt));
    }
    for (core::Finding& finding : found) {
        core::settle_severity(input.setup, finding);
        if (finding.severity == core::Severity::off) continue;
        const auto after = std::find_if(record.findings.begin(), record.findings.end(),
                                        [&](const core::Finding& other) {
                                            return !other.block || *other.block > *finding.block;
                                        });
        record.findings.insert(after, std::move(finding));
    }
}

void list_changed_severities(const CheckInput& input, CheckRecord& record) {
    for (const auto& [rule, severity] : input.setup.rules) {
        const core::Severity own = core::default_severity(rule).value_or(severity);
        if (severity == own || own == core::Severity::off) continue; // one more rule hides nothing
        record.later_assumptions.push_back(
            severity == core::Severity::off
                ? fmt::format("the set-up switches {} off; collisions are reported all the same",
                              rule)
                : fmt::format("the set-up reports {} as {} instead of {}", rule,
                              core::name_of(severity), core::name_of(own)));
    }
}

} // namespace

std::vector<AllowedRule> allowed_rules(std::string_view line) {
    std::vector<AllowedRule> rules;
    const std::string low = core::lower_case(line);
    for (size_t at = low.find_first_of("(;"); at != std::string::npos;
         at = low.find_first_of("(;", at + 1)) {
        std::string_view rest = std::string_view(low).substr(at + 1);
        if (!take(rest, "feeler") || !take(rest, ":") || !take(rest, "allow")) continue;
        const std::string_view names = rest.substr(0, rest.find(')'));
        const auto before = static_cast<size_t>(names.data() - low.data());
        constexpr const char* letters = "abcdefghijklmnopqrstuvwxyz0123456789-";
        for (size_t i = names.find_first_of(letters); i != std::string_view::npos;) {
            const size_t end = std::min(names.find_first_not_of(letters, i), names.size());
            rules.push_back({std::string(names.substr(i, end - i)), before + i + 1});
            i = names.find_first_of(letters, end);
        }
    }
    return rules;
}

void apply_allowed_rules(const CheckInput& input, CheckRecord& record, bool comments_count) {
    list_changed_severities(input, record);
    report_invalid_comments(input, record, comments_count);
    std::map<std::string, std::vector<uint32_t>> allowed, refused; // lines, by message
    const auto judge = [&](const core::Finding& finding) {
        if (!is_allowed(record, finding)) return false;
        const uint32_t line = record.blocks.line(core::value_of(*finding.block));
        const bool collides = comes_of_a_collision(input, record, finding);
        if (comments_count && !collides)
            allowed[finding.rule].push_back(line);
        else
            refused[collides ? "a collision is never allowed"
                             : "allow_comments = true is missing under [rules] of the set-up"]
                .push_back(line);
        return comments_count && !collides;
    };
    std::erase_if(record.findings, judge);
    for (const auto& [rule, lines] : allowed)
        record.later_assumptions.push_back(fmt::format(
            "comments in the program allow {} in {}: {} omitted", rule, lines_text(lines),
            lines.size() == 1 ? "one finding is" : fmt::format("{} findings are", lines.size())));
    for (const auto& [why, lines] : refused)
        record.later_assumptions.push_back(fmt::format(
            "a comment that allows a rule has no effect in {}: {}", lines_text(lines), why));
}

namespace {

/// A hash of a motion: kind, both ends and arc angle.
uint64_t digest_of(const core::Motion& motion) {
    uint64_t digest = 14695981039346656037U;
    const auto add = [&](double value) {
        digest = (digest ^ std::hash<double>{}(value)) * 1099511628211U;
    };
    add(static_cast<double>(motion.kind));
    for (const auto& position : {motion.from, motion.to})
        for (const auto& axis : position) add(axis.value_or(1e300));
    if (motion.arc) add(motion.arc->angle);
    return digest;
}

/// A motion, and its line.
struct Step {
    uint64_t digest;
    uint32_t line;
};

std::vector<Step> steps_of(const gcode::Program& program, gcode::Environment environment,
                           bool block_delete) {
    environment.block_delete = block_delete;
    environment.control.answers.erase(gcode::ControlQuestion::blocks_are_deleted);
    environment.control.reports_premises = false;
    std::vector<Step> steps;
    visit_events(program, environment, [&](const ProgramEvent& event) {
        if (const auto* motion = std::get_if<core::Motion>(&event.event))
            steps.push_back({digest_of(*motion), event.line});
    });
    return steps;
}

/// Whether the check has followed the reading in which blocks with `/` are skipped, to its end.
bool other_position_was_checked(const CheckRecord& record, const gcode::Environment& environment) {
    const gcode::ControlParameter* parameter =
        gcode::find_parameter(gcode::ControlQuestion::blocks_are_deleted, environment.dialect);
    if (!parameter) return false;
    const std::string reason = gcode::premise_of(*parameter, environment).reason;
    return std::any_of(record.readings.begin(), record.readings.end(),
                       [&](const ReadingResult& reading) {
                           return reading.premise.reason == reason && !reading.stopped;
                       });
}

} // namespace

void check_both_switch_positions(const CheckInput& input, CheckRecord& record,
                                 const gcode::Program& program,
                                 const gcode::Environment& environment) {
    const auto note =
        std::find_if(record.findings.begin(), record.findings.end(),
                     [](const auto& f) { return f.rule == core::rule_id("block-delete"); });
    if (note == record.findings.end()) return;
    const std::vector<Step> off = steps_of(program, environment, false);
    const std::vector<Step> on = steps_of(program, environment, true);
    const auto [here, there] =
        std::mismatch(off.begin(), off.end(), on.begin(), on.end(),
                      [](const Step& a, const Step& b) { return a.digest == b.digest; });
    if (here == off.end() && there == on.end()) {
        note->message = "blocks with '/' are run here; the path is the same with block delete on";
        note->cure.clear();
        return;
    }
    const uint32_t line = here != off.end() ? here->line : there->line;
    note->message =
        fmt::format("blocks with '/' are run here; with block delete on at the machine, "
                    "the path is different from line {} on",
                    line);
    if (other_position_was_checked(record, environment)) {
        note->message += "; both positions of the switch were checked";
        note->cure.clear();
        return;
    }
    note->severity = core::severity_of(input.setup, note->rule);
}

namespace {

/// Regions beyond this number are only counted.
constexpr size_t most_findings = 10;

core::Finding finding_of(const core::DeviationRegion& region) {
    const bool gouge = region.kind == core::Deviation::gouge;
    core::Finding finding;
    finding.rule = gouge ? core::rule_id("gouge") : core::rule_id("rest-material");
    if (region.block) finding.block = core::BlockIndex{*region.block};
    const std::string where =
        fmt::format("at X {:.3f} Y {:.3f} Z {:.3f} of the stock, over about {:.1f} mm2",
                    region.position.x, region.position.y, region.position.z, region.area);
    finding.message =
        fmt::format("{} mm {} {}.", core::at_most(region.amount),
                    gouge ? "of the part is missing" : "of excess material is left", where);
    if (gouge)
        finding.cure = region.block
                           ? "Check the path, the tool's dimensions and the offsets of this block."
                           : "The raw stock does not contain the part here: use a larger stock or "
                             "move the part.";
    finding.shortfall = region.amount;
    return finding;
}

void add(const CheckInput& input, CheckRecord& record, core::Finding finding) {
    finding.severity = core::severity_of(input.setup, finding.rule);
    if (finding.severity != core::Severity::off) record.findings.push_back(std::move(finding));
}

void add_findings(const CheckInput& input, CheckRecord& record,
                  const core::PartComparison& comparison, core::Deviation kind) {
    size_t reported = 0, more = 0;
    for (const core::DeviationRegion& region : comparison.regions) {
        if (region.kind != kind) continue;
        if (reported++ < most_findings)
            add(input, record, finding_of(region));
        else
            ++more;
    }
    if (more == 0) return;
    core::Finding finding;
    finding.rule =
        kind == core::Deviation::gouge ? core::rule_id("gouge") : core::rule_id("rest-material");
    finding.message = fmt::format("{} more regions deviate from the part by less.", more);
    add(input, record, finding);
}

/// Colour of a deviation: green within the tolerance; from yellow to red for gouges and from cyan
/// to blue for excess material, with full colour from five times the tolerance on.
core::Colour colour_of(double deviation, double tolerance) {
    const double off = std::abs(deviation);
    if (off <= tolerance) return {80, 170, 80};
    const double fraction = std::clamp((off - tolerance) / (4.0 * tolerance), 0.0, 1.0);
    const auto fading = static_cast<uint8_t>(220.0 * (1.0 - fraction));
    if (deviation < 0.0) return {230, fading, 0};
    return {0, fading, 230};
}

} // namespace

void check_part(const CheckInput& input, CheckRecord& record, CheckReport& report) {
    if (!input.setup.part || !report.surface) return;
    report.comparison = std::make_shared<const core::PartComparison>(
        core::compare_with_part(*report.stock, *report.surface, *input.setup.part));
    for (const core::Deviation kind : {core::Deviation::gouge, core::Deviation::excess})
        add_findings(input, record, *report.comparison, kind);
}

std::string facts_of(const core::PartComparison& comparison, const core::Part& part) {
    const auto up_to = [&](double amount) {
        return core::at_most(amount > 0.0 ? amount + part.deviation : 0.0);
    };
    return fmt::format(
        "gouges up to {} mm, excess up to {} mm; {} beyond {} mm; sampled every {} "
        "mm{}",
        up_to(comparison.largest_gouge), up_to(comparison.largest_excess),
        comparison.regions.size() == 1 ? "1 region"
                                       : fmt::format("{} regions", comparison.regions.size()),
        core::number_text(part.limit(), 4), core::at_most_figures(comparison.between_samples, 2),
        part.deviation > 0.0
            ? fmt::format("; the part's mesh within {} mm", core::at_most(part.deviation, 4))
            : "");
}

core::Result<std::string> comparison_file(const CheckRun& run, const std::string& path) {
    const auto refused = [&](const std::string& why) { return core::fail_file(path, why); };
    FEELER_TRY(const MeshForm form, mesh_form(path));
    if (form != MeshForm::ply) return refused("cannot hold colours: the name must end in .ply");
    if (!run.comparison)
        return refused("was not written: the set-up has no [part] to compare with");
    if (run.surface->mesh.triangles.empty()) return refused("was not written: no stock is left");
    const double tolerance = run.setup.part->tolerance;
    std::vector<core::Colour> colours;
    for (const double deviation : run.comparison->deviations)
        colours.push_back(colour_of(deviation, tolerance));
    return core::ply_bytes(
        run.surface->mesh,
        {"remaining stock and its deviation from the part, by feeler; mm, frame of the stock",
         fmt::format("green: within {} mm of the part", tolerance),
         fmt::format("yellow to red: gouged, {} to {} mm and more", tolerance, 5.0 * tolerance),
         fmt::format("cyan to blue: excess material, {} to {} mm and more", tolerance,
                     5.0 * tolerance),
         fmt::format(
             "each corner has the colour of the largest deviation next to it; sampled every {} mm",
             core::at_most_figures(run.comparison->between_samples, 2))},
        colours);
}

} // namespace app

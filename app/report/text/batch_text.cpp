#include "app/report/text/batch_text.h"

#include <algorithm>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "app/base/findings.h"
#include "app/base/text.h"
#include "app/library/result/batch_result.h"

namespace app {
namespace {

using core::Severity;

constexpr int red = 31, green = 32, yellow = 33; // ANSI colour codes

int colour_of(Outcome outcome) {
    if (outcome == Outcome::clear) return green;
    if (outcome == Outcome::no_error || outcome == Outcome::no_motion) return yellow;
    return outcome == Outcome::undecided || outcome == Outcome::violation ? yellow : red;
}

std::string coloured(const std::string& text, int colour, const BatchStyle& style) {
    return style.colour ? fmt::format("\033[{}m{}\033[0m", colour, text) : text;
}

std::string nonzero_counts(const ProgramResult& result) {
    std::string text;
    for (const Severity severity : {Severity::error, Severity::warning, Severity::note})
        if (const size_t count = count_of(result, severity))
            text += (text.empty() ? "" : ", ") + counted(count, core::name_of(severity));
    return text;
}

using RuleKey = std::tuple<int, std::string, std::string>;

/// Severity, the worst first, rule and file.
RuleKey rule_key(const StoredFinding& finding) {
    return {-static_cast<int>(finding.severity), finding.rule, finding.file};
}

/// The findings of one severity, rule and file together.
std::vector<GroupOf<StoredFinding>> rule_groups(const ProgramResult& result) {
    auto groups = grouped_by(result.findings, rule_key);
    std::sort(groups.begin(), groups.end(),
              [](const auto& a, const auto& b) { return rule_key(*a.worst) < rule_key(*b.worst); });
    return groups;
}

/// A line for each rule with findings: its line numbers and the message of its worst finding; the
/// worst rule first.
std::string rule_lines(const ProgramResult& result, const BatchStyle& style) {
    std::string text;
    for (const GroupOf<StoredFinding>& group : rule_groups(result)) {
        const StoredFinding& worst = *group.worst;
        if (worst.severity != Severity::error && !style.verbose) continue;
        std::string line = finding_title(worst);
        if (!worst.file.empty()) line += " in " + trimmed(worst.file);
        std::set<uint32_t> lines;
        for (const StoredFinding* finding : group.findings)
            if (finding->line != 0) lines.insert(finding->line);
        if (!lines.empty())
            line += fmt::format(", line{} {}", lines.size() == 1 ? "" : "s",
                                line_ranges({lines.begin(), lines.end()}));
        text += wrapped(line + ": " + worst.message, 11, 2);
    }
    return text;
}

std::string location_text(const StoredError& error, const std::string& program) {
    std::string location = error.file.empty() ? program : error.file;
    if (error.line != 0) location += fmt::format(":{}", error.line);
    if (error.line != 0 && error.column != 0) location += fmt::format(":{}", error.column);
    return trimmed(location);
}

std::string error_line(const ProgramResult& result) {
    return location_text(*result.error, result.program) + ": " + result.error->message;
}

/// The error for a line below that of the program: as error_line, but without the program's name.
std::string own_error_line(const ProgramResult& result) {
    const StoredError& error = *result.error;
    const bool is_own = error.file.empty() || error.file == result.program;
    if (!is_own) return error_line(result);
    return error.line == 0 ? error.message : fmt::format("line {}: {}", error.line, error.message);
}

std::string verdicts_text(const BatchResult& batch) {
    std::array<size_t, all_outcomes.size()> counts{};
    for (const ProgramResult& program : batch.programs)
        ++counts[static_cast<size_t>(outcome_of(program))];
    counts[static_cast<size_t>(Outcome::unchecked)] = batch.unchecked.size();
    std::string text;
    for (const Outcome outcome :
         {Outcome::clear, Outcome::no_error, Outcome::no_motion, Outcome::collision,
          Outcome::violation, Outcome::undecided, Outcome::errors, Outcome::stopped,
          Outcome::not_run, Outcome::unchecked})
        if (const size_t count = counts[static_cast<size_t>(outcome)])
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name_of(outcome));
    return text;
}

std::string rules_text(const BatchResult& batch) {
    std::string text;
    for (const RuleTally& tally : rule_tallies(batch))
        text += fmt::format("  {:<8} {:<26} {:>7} in {}\n", core::name_of(tally.severity),
                            tally.rule, tally.findings, counted(tally.programs, "program"));
    return text;
}

std::string slowest_text(const BatchResult& batch) {
    constexpr size_t shown = 3;
    std::vector<const ProgramResult*> slowest;
    for (const ProgramResult& program : batch.programs) slowest.push_back(&program);
    const size_t count = std::min(shown, slowest.size());
    std::partial_sort(slowest.begin(), slowest.begin() + static_cast<std::ptrdiff_t>(count),
                      slowest.end(),
                      [](const auto* a, const auto* b) { return a->seconds > b->seconds; });
    std::string text;
    for (size_t i = 0; i < count; ++i)
        text += fmt::format("  slowest  {:>7.2f} s  {}\n", slowest[i]->seconds,
                            trimmed(slowest[i]->program));
    return text;
}

/// The first lines of a list; all of them if verbose.
std::string list_text(const std::vector<std::string>& lines, const BatchStyle& style) {
    constexpr size_t shown = 10;
    const size_t most = style.verbose ? lines.size() : std::min(lines.size(), shown);
    std::string text;
    for (size_t i = 0; i < most; ++i) text += wrapped(lines[i], 2, 2);
    if (most < lines.size())
        text += fmt::format("  ... and {} more (--verbose names them)\n", lines.size() - most);
    return text;
}

/// A line for each skipped file, or for each reason that many files share.
std::vector<std::string> skipped_lines(const BatchResult& batch, const BatchStyle& style) {
    constexpr size_t few = 3;
    std::vector<std::string> lines;
    for (const SkippedGroup& group : skipped_groups(batch.skipped)) {
        const size_t count = group.files.size();
        const bool each = style.verbose || count <= few;
        if (!each)
            lines.push_back(fmt::format("skipped: {} files, such as {}: {}", count,
                                        trimmed(group.files[0]), group.why));
        for (size_t i = 0; each && i < count; ++i)
            lines.push_back(fmt::format("skipped: {}: {}", trimmed(group.files[i]), group.why));
    }
    return lines;
}

/// Programs that stopped early, and why; programs that were not checked; skipped files.
std::string missing_text(const BatchResult& batch, const BatchStyle& style) {
    std::vector<std::string> stopped, unchecked;
    for (const ProgramResult& program : batch.programs)
        if (program.error) stopped.push_back("not run to its end: " + error_line(program));
    for (const std::string& program : batch.unchecked)
        unchecked.push_back("not checked: " + trimmed(program));
    return list_text(stopped, style) + list_text(unchecked, style)
           + (style.quiet ? std::string() : list_text(skipped_lines(batch, style), style));
}

} // namespace

std::string uncovered_summary(const BatchResult& batch) {
    std::string text;
    for (const Known known : {Known::missing, Known::inferred}) {
        std::string items;
        for (size_t item = 0; item < items_of(Coverage()).size(); ++item) {
            const auto lacks = [&](const ProgramResult& program) {
                return program.coverage && items_of(*program.coverage)[item].known == known;
            };
            const auto count = static_cast<size_t>(
                std::count_if(batch.programs.begin(), batch.programs.end(), lacks));
            if (count == 0) continue;
            items += fmt::format("{}{} in {}", items.empty() ? "" : ", ",
                                 items_of(Coverage())[item].name, count);
        }
        if (items.empty()) continue;
        text += (text.empty() ? "" : "; ") + items
                + (known == Known::missing ? ": not described" : ": assumed");
    }
    return text;
}

std::string program_text(const ProgramResult& result, const BatchStyle& style) {
    if (style.quiet && status_of(result) == 0) return {};
    const Outcome outcome = outcome_of(result);
    const std::string word = fmt::format("{:<10}", name_of(outcome));
    std::string text = " " + trimmed(result.program);
    const std::string counts = nonzero_counts(result);
    if (!counts.empty()) text += ": " + counts;
    text += "\n";
    if (result.error) text += wrapped(own_error_line(result), 11, 2);
    const std::string uncovered = uncovered_text(result);
    if (style.verbose && !uncovered.empty()) text += wrapped("unchecked: " + uncovered, 11, 2);
    text += rule_lines(result, style);
    for (size_t i = 0; style.verbose && i < result.assumptions.size(); ++i)
        text += wrapped("assumed: " + result.assumptions[i], 11, 2);
    return coloured(word, colour_of(outcome), style) + printable(text);
}

std::string batch_summary(const BatchResult& batch, double seconds, const BatchStyle& style) {
    std::string text = batch.shard.empty() ? batch.shard : batch.shard + "\n";
    text += counted(batch.programs.size() + batch.unchecked.size(), "program");
    if (seconds >= 60.0) text += " in " + duration_text(seconds);
    if (seconds >= 0.0 && seconds < 60.0) text += fmt::format(" in {:.1f} s", seconds);
    const std::string verdicts = verdicts_text(batch);
    text += (verdicts.empty() ? verdicts : ": " + verdicts) + "\n";
    if (const std::string uncovered = uncovered_summary(batch); !uncovered.empty())
        text += wrapped("unchecked: " + uncovered, 2, 2);
    text += rules_text(batch);
    if (seconds >= 0.0) text += slowest_text(batch);
    return printable(text + missing_text(batch, style));
}

std::string batch_text(const BatchResult& batch, const BatchStyle& style) {
    std::string text;
    for (const ProgramResult& program : batch.programs) text += program_text(program, style);
    return text + "\n" + batch_summary(batch, -1.0, style);
}

namespace {

/// Sort key that puts errors first.
using Key = std::pair<int, std::string>;

Key key_of(core::Severity severity, const std::string& rule) {
    return {-static_cast<int>(severity), rule};
}

std::vector<RuleTally> values_of(const std::map<Key, RuleTally>& tallies) {
    std::vector<RuleTally> values;
    for (const auto& [key, tally] : tallies) values.push_back(tally);
    return values;
}

} // namespace

std::vector<RuleTally> rule_tallies(const ProgramResult& program) {
    std::map<Key, RuleTally> tallies;
    for (const StoredFinding& finding : program.findings) {
        const RuleTally fresh{finding.severity, finding.rule, 1, 0};
        ++tallies.try_emplace(key_of(finding.severity, finding.rule), fresh).first->second.findings;
    }
    return values_of(tallies);
}

std::vector<RuleTally> rule_tallies(const BatchResult& batch) {
    std::map<Key, RuleTally> tallies;
    for (const ProgramResult& program : batch.programs)
        for (const RuleTally& here : rule_tallies(program)) {
            const RuleTally fresh{here.severity, here.rule, 0, 0};
            RuleTally& tally =
                tallies.try_emplace(key_of(here.severity, here.rule), fresh).first->second;
            ++tally.programs;
            tally.findings += here.findings;
        }
    return values_of(tallies);
}

std::vector<SkippedGroup> skipped_groups(const std::vector<SkippedFile>& skipped) {
    std::map<std::string, std::vector<std::string>> files;
    for (const SkippedFile& file : skipped) files[file.why].push_back(file.path);
    std::vector<SkippedGroup> groups;
    for (auto& [why, paths] : files) groups.push_back({why, std::move(paths)});
    std::stable_sort(groups.begin(), groups.end(),
                     [](const auto& a, const auto& b) { return a.files.size() > b.files.size(); });
    return groups;
}

} // namespace app

#include "app/session/allowed_rules.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include <fmt/format.h>

namespace app {
namespace {

std::string lower(std::string_view text) {
    std::string low(text);
    for (char& letter : low)
        letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return low;
}

/// "line 7", "lines 7, 9, 12".
std::string lines_text(const std::vector<uint32_t>& lines) {
    std::string text;
    for (const uint32_t line : lines) text += (text.empty() ? "" : ", ") + std::to_string(line);
    return (lines.size() == 1 ? "line " : "lines ") + text;
}

/// Takes a word off the front, if it is there.
bool take(std::string_view& text, std::string_view word) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    if (text.substr(0, word.size()) != word) return false;
    text.remove_prefix(word.size());
    return true;
}

bool comes_of_a_collision(const CheckRun& run, const core::Finding& finding) {
    if (finding.rule == "collision") return true;
    const core::BlockResult& block = run.blocks[core::value_of(*finding.block)].result;
    return std::any_of(block.pairs.begin(), block.pairs.end(),
                       [&](const core::PairClearance& pair) {
                           return pair.verdict == core::Verdict::collision
                                  && core::part_name(run.setup, pair.pair) == finding.pair[0]
                                  && core::body_name(run.setup, pair.pair) == finding.pair[1];
                       });
}

bool is_allowed(const CheckRun& run, const core::Finding& finding) {
    if (!finding.block) return false;
    const std::string& text = run.blocks[core::value_of(*finding.block)].text;
    if (text.find_first_of("(;") == std::string::npos) return false;
    const std::vector<AllowedRule> rules = allowed_rules(text);
    return std::any_of(rules.begin(), rules.end(),
                       [&](const AllowedRule& rule) { return rule.name == finding.rule; });
}

core::Finding about_comment(const CheckedBlock& block, const AllowedRule& rule,
                            core::Severity severity) {
    core::Finding finding;
    finding.rule = "program";
    finding.severity = severity;
    finding.block = block.block;
    finding.message = fmt::format("Line {}, column {}: the comment allows {}", block.line,
                                  rule.column, rule.name);
    return finding;
}

/// What is wrong with a name in a comment, if anything is.
std::optional<core::Finding> doubt_about(const CheckedBlock& block, const AllowedRule& rule,
                                         bool comments_count) {
    if (!core::default_severity(rule.name)) {
        core::Finding finding = about_comment(block, rule, core::Severity::warning);
        finding.message += ", and there is no rule of that name: nothing is allowed by it.";
        finding.cure = fmt::format("Write {} if that is meant.", core::nearest_rule(rule.name));
        return finding;
    }
    if (comments_count) return std::nullopt;
    core::Finding finding = about_comment(block, rule, core::Severity::note);
    finding.message += ", but the set-up does not permit that: the comment does not count.";
    finding.cure = "Say allow_comments = true under [rules] if comments shall count.";
    return finding;
}

/// Looks at every comment of the lines that were run, once.
void say_doubtful_comments(CheckRun& run, bool comments_count) {
    std::set<std::pair<std::string, uint32_t>> seen;
    std::vector<core::Finding> found;
    for (const CheckedBlock& block : run.blocks) {
        if (block.text.find_first_of("(;") == std::string::npos) continue;
        if (!seen.emplace(block.file, block.line).second) continue;
        for (const AllowedRule& rule : allowed_rules(block.text))
            if (auto doubt = doubt_about(block, rule, comments_count))
                found.push_back(*std::move(doubt));
    }
    for (core::Finding& finding : found) {
        if (const auto set = run.setup.rules.find(finding.rule); set != run.setup.rules.end())
            finding.severity = set->second;
        if (finding.severity == core::Severity::off) continue;
        const auto behind =
            std::find_if(run.findings.begin(), run.findings.end(), [&](const core::Finding& other) {
                return !other.block || *other.block > *finding.block;
            });
        run.findings.insert(behind, std::move(finding));
    }
}

void say_severities(CheckRun& run) {
    for (const auto& [rule, severity] : run.setup.rules) {
        const core::Severity own = core::default_severity(rule).value_or(severity);
        if (severity == own) continue;
        run.assumptions.push_back(
            severity == core::Severity::off
                ? fmt::format("{} is switched off by the set-up; a collision is told all the same",
                              rule)
                : fmt::format("the set-up has {} told as {}, not as {}", rule,
                              core::name_of(severity), core::name_of(own)));
    }
}

} // namespace

std::vector<AllowedRule> allowed_rules(std::string_view line) {
    std::vector<AllowedRule> rules;
    const std::string low = lower(line);
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

void apply_allowed_rules(CheckRun& run, bool comments_count) {
    say_severities(run);
    say_doubtful_comments(run, comments_count);
    std::map<std::string, std::vector<uint32_t>> allowed, refused; // lines, by what is said of them
    const auto judge = [&](const core::Finding& finding) {
        if (!is_allowed(run, finding)) return false;
        const uint32_t line = run.blocks[core::value_of(*finding.block)].line;
        const bool collides = comes_of_a_collision(run, finding);
        if (comments_count && !collides)
            allowed[finding.rule].push_back(line);
        else
            refused[collides ? "a collision is never allowed"
                             : "the set-up does not say allow_comments = true under [rules]"]
                .push_back(line);
        return comments_count && !collides;
    };
    std::erase_if(run.findings, judge);
    for (const auto& [rule, lines] : allowed)
        run.assumptions.push_back(fmt::format(
            "comments in the program allow {} in {}: {} left out", rule, lines_text(lines),
            lines.size() == 1 ? "one finding is" : fmt::format("{} findings are", lines.size())));
    for (const auto& [why, lines] : refused)
        run.assumptions.push_back(fmt::format(
            "a comment that allows a rule does not count in {}: {}", lines_text(lines), why));
}

} // namespace app

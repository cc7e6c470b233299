#include "app/session/allowed_rules.h"

#include <algorithm>
#include <cctype>
#include <map>

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
    const std::vector<std::string> rules = allowed_rules(text);
    return std::find(rules.begin(), rules.end(), finding.rule) != rules.end();
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

std::vector<std::string> allowed_rules(std::string_view line) {
    std::vector<std::string> rules;
    const std::string low = lower(line);
    for (size_t at = low.find_first_of("(;"); at != std::string::npos;
         at = low.find_first_of("(;", at + 1)) {
        std::string_view rest = std::string_view(low).substr(at + 1);
        if (!take(rest, "feeler") || !take(rest, ":") || !take(rest, "allow")) continue;
        std::string name;
        for (const char letter : rest.substr(0, rest.find(')'))) {
            if (std::isalnum(static_cast<unsigned char>(letter)) || letter == '-') {
                name += letter;
            } else if (!name.empty()) {
                rules.push_back(std::exchange(name, {}));
            }
        }
        if (!name.empty()) rules.push_back(name);
    }
    return rules;
}

void apply_allowed_rules(CheckRun& run, bool comments_count) {
    say_severities(run);
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

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace core {

enum class Severity : uint8_t { off, note, warning, error };

inline constexpr std::array all_severities = {Severity::off, Severity::note, Severity::warning,
                                              Severity::error};

const char* name_of(Severity severity);

/// A kind of finding: one entry in the table of rules. SARIF, HTML and the manual show its texts.
struct RuleEntry {
    std::string_view name;  // stable id; set-ups and comments in programs refer to it
    std::string_view title; // in plain words, a few
    Severity severity;      // unless the set-up overrides it
    std::string_view meaning;
    std::string_view cure;
};

/// All rules.
std::span<const RuleEntry> rule_table();

/// The rule with this name; null if there is none.
const RuleEntry* find_rule(std::string_view name);

/// The title of the rule with this name; the name itself if there is no such rule.
std::string title_of_rule(const std::string& name);

/// The names of all rules.
std::vector<std::string> rule_names();

/// Default severity of a rule; empty if there is no such rule.
std::optional<Severity> default_severity(const std::string& rule);

/// The rule name with the smallest edit distance from `name`.
std::string nearest_rule(const std::string& name);

} // namespace core

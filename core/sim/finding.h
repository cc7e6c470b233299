#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/ids.h"

namespace core {

struct Setup;

enum class Severity : uint8_t { off, note, warning, error };

const char* name_of(Severity severity);

/// A fact about a block that a person should know.
struct Finding {
    std::string rule; // stable id, such as `near-miss`
    Severity severity = Severity::warning;
    std::optional<BlockIndex> block;   // empty: the program as a whole
    std::string message;               // one or two sentences, in a machinist's words
    std::string cure;                  // what removes it; may be empty
    std::array<std::string, 2> pair{}; // the two bodies concerned; empty if there are none
    double shortfall = 0.0;            // minimum clearance minus clearance, mm

    bool operator==(const Finding&) const = default;
};

/// Severities from the set-up, by rule name. They override the defaults.
using RuleSeverities = std::map<std::string, Severity>;

/// Default severity of a rule; empty if there is no such rule.
std::optional<Severity> default_severity(const std::string& rule);

/// Severity of a rule in this set-up.
Severity severity_of(const Setup& setup, const std::string& rule);

/// Sets the severity of a finding to that of its rule in this set-up. A note stays a note unless
/// the set-up names its rule.
void settle_severity(const Setup& setup, Finding& finding);

/// The rule name with the smallest edit distance from `name`.
std::string nearest_rule(const std::string& name);

/// A kind of finding: one entry in the table of rules. SARIF, HTML and the manual show its texts.
struct RuleEntry {
    std::string_view name; // stable id; set-ups and comments in programs refer to it
    Severity severity;     // unless the set-up overrides it
    std::string_view meaning;
    std::string_view cure;
};

/// All rules.
std::span<const RuleEntry> rule_table();

/// The rule with this name; null if there is none.
const RuleEntry* find_rule(std::string_view name);

/// The names of all rules.
std::vector<std::string> rule_names();

} // namespace core

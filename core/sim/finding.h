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

/// Something a person should know about a block.
struct Finding {
    std::string rule; // stable name, as in `near-miss`
    Severity severity = Severity::warning;
    std::optional<BlockIndex> block;   // empty: the program as a whole
    std::string message;               // one or two sentences as a machinist would say them
    std::string cure;                  // what would make it go away; may be empty
    std::array<std::string, 2> pair{}; // the part and the body it is about; empty if about none
    double shortfall = 0.0;            // how much is missing of what must be kept, mm
};

/// What the set-up says about rules by name, in place of their own severity.
using RuleSeverities = std::map<std::string, Severity>;

/// The severity that a rule has unless the set-up changes it; empty if no rule has that name.
std::optional<Severity> default_severity(const std::string& rule);

/// The severity of a rule in this set-up.
Severity severity_of(const Setup& setup, const std::string& rule);

/// Gives a finding whose rule has left that open its severity in this set-up. A note stays one
/// unless the set-up names its rule.
void settle_severity(const Setup& setup, Finding& finding);

/// The rule whose name takes the fewest letters changed, put in or left out to make it from this
/// one.
std::string nearest_rule(const std::string& name);

/// A kind of finding: one row of the table of rules. SARIF, HTML and the manual show its texts.
struct RuleEntry {
    std::string_view name; // stable id; set-ups and comments in programs refer to it
    Severity severity;     // unless the set-up says otherwise
    std::string_view meaning;
    std::string_view cure;
};

/// All rules.
std::span<const RuleEntry> rule_table();

/// The rule of that name; null if there is none.
const RuleEntry* find_rule(std::string_view name);

/// The names of all rules.
std::vector<std::string> rule_names();

} // namespace core

#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "core/base/ids.h"
#include "core/base/rule.h"

namespace core {

struct Setup;

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

/// Severity of a rule in this set-up.
Severity severity_of(const Setup& setup, const std::string& rule);

/// Sets the severity of a finding to that of its rule in this set-up. A note stays a note unless
/// the set-up names its rule.
void settle_severity(const Setup& setup, Finding& finding);

} // namespace core

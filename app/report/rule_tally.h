#pragma once

#include <string>
#include <vector>

#include "app/batch/batch_result.h"

namespace app {

/// How often a rule was found, with one severity.
struct RuleTally {
    core::Severity severity = core::Severity::off;
    std::string rule;
    size_t programs = 0, findings = 0;

    bool operator==(const RuleTally&) const = default;
};

/// Of one program; errors first, then by the names of the rules.
std::vector<RuleTally> rule_tallies(const ProgramResult& program);

/// Of all programs, in the same order.
std::vector<RuleTally> rule_tallies(const BatchResult& batch);

} // namespace app

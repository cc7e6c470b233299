#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/sim/finding.h"

namespace core {

/// A rule by its stable name, with the severity that it has unless the set-up says otherwise.
struct RuleEntry {
    const char* name;
    Severity severity;
};

/// Every rule a set-up may name.
std::span<const RuleEntry> rule_table();

/// Their names.
std::vector<std::string> rule_names();

} // namespace core

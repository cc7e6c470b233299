#pragma once

#include <string_view>

namespace app {

/// What a rule finds, in a sentence, and what a person does about it.
struct RuleHelp {
    std::string_view rule, finds, cure;
};

/// The help of a rule of core::rule_table; both sentences are empty for a name that is no rule.
RuleHelp help_of(std::string_view rule);

} // namespace app

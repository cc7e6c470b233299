#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/session/check_run.h"

namespace app {

/// A name in a comment that allows a rule, in small letters, and where it begins, from 1.
struct AllowedRule {
    std::string name;
    size_t column = 0;
};

/// The names in the comments of a line that allow rules: (feeler: allow RULE, RULE), or the same
/// behind a semicolon.
std::vector<AllowedRule> allowed_rules(std::string_view line);

/// Takes those findings out of a run that comments in their own lines allow, where the set-up
/// permits that; one that comes of a collision stays. What was taken out, and what comments did not
/// count, is added to the assumptions, like every rule to which the set-up gives another severity.
/// A name that is no rule is a warning, and a comment that the set-up does not permit a note.
void apply_allowed_rules(CheckRun& run, bool comments_count);

} // namespace app

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace core {
struct PartComparison;
struct SimulatorState;
} // namespace core
namespace gcode {
struct Environment;
struct Program;
} // namespace gcode

namespace app {

struct CheckRun;
struct LengthMismatch;
struct PreparedCheck;

/// What can be said only of a whole run, once its last block was carried out: findings in their
/// order, those that one cause explains made one, comments that allow rules, the part, the stock
/// that is left.
void conclude(PreparedCheck& check, core::SimulatorState end,
              const std::vector<LengthMismatch>& mismatches, bool needs_surface);

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

/// Looks whether the machine moves otherwise when the switch for blocks with `/` is on, if the run
/// has a note that there are such blocks. If so, the note gets the severity of its rule.
void look_at_both_switch_positions(CheckRun& run, const gcode::Program& program,
                                   const gcode::Environment& environment);

/// Holds what is left of the stock against the part of the set-up, if there is one: fills
/// `run.comparison`, and adds a finding for each of the worst regions, `gouge` or `rest-material`.
void check_part(CheckRun& run);

/// What came of it in a line of text.
std::string facts_of(const core::PartComparison& comparison, double tolerance);

/// The surface of what is left as a PLY file, coloured by its deviation from the part; the header
/// says what the colours mean.
///
/// Errors: invalid_value when the set-up has no part, and for a name that does not end in .ply.
core::Result<std::string> comparison_file(const CheckRun& run, const std::string& path);

} // namespace app

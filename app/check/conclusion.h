#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/sim/finding.h"

namespace core {
struct Part;
struct PartComparison;
struct Setup;
struct SimulatorState;
} // namespace core
namespace gcode {
struct Environment;
struct Program;
} // namespace gcode

namespace app {

struct CheckInput;
struct CheckRecord;
struct CheckReport;
struct CheckRun;
struct LengthMismatch;
struct PreparedCheck;
struct RunState;

/// Completes a run after its last block: sorts the findings, combines those with one cause, applies
/// comments that allow rules, compares with the part, and stores the remaining stock.
void conclude(PreparedCheck& check, const core::SimulatorState& end,
              const std::vector<LengthMismatch>& mismatches, bool needs_surface);

/// A rule that a comment allows: its name in lower case and its column, from 1.
struct AllowedRule {
    std::string name;
    size_t column = 0;
};

/// The rules that the comments of a line allow, written (feeler: allow RULE, RULE), or the same
/// after a semicolon.
std::vector<AllowedRule> allowed_rules(std::string_view line);

/// Removes the findings that comments in their own lines allow, if the set-up permits such
/// comments; findings of collisions stay. Adds to the assumptions: the removed findings, comments
/// without effect, and each rule whose severity the set-up changes. An unknown rule name gives a
/// warning; a comment that the set-up does not permit gives a note.
void apply_allowed_rules(const CheckInput& input, CheckRecord& record, bool comments_count);

/// If the record has a note about blocks with `/`, checks whether the path differs when block
/// delete is on. If so, and the other readings of the record do not include that position of the
/// switch, raises the note to the severity of its rule.
void check_both_switch_positions(const CheckInput& input, CheckRecord& record,
                                 const gcode::Program& program,
                                 const gcode::Environment& environment);

/// Compares the remaining stock with the part of the set-up, if there is one: fills
/// `report.comparison`, and adds a finding `gouge` or `rest-material` for each of the worst
/// regions.
void check_part(const CheckInput& input, CheckRecord& record, CheckReport& report);

/// The result of the comparison as one line of text.
std::string facts_of(const core::PartComparison& comparison, const core::Part& part);

/// The surface of the remaining stock as a PLY file, coloured by its deviation from the part. The
/// header explains the colours.
///
/// Errors: invalid_value if the set-up has no part or the name does not end in .ply.
core::Result<std::string> comparison_file(const CheckRun& run, const std::string& path);

/// The findings about a whole run that contradicts itself or cannot be meant:
/// `implausible-value`, at most one for each kind of value (a feed above the rapid speed of the
/// machine in the set-up is a warning, because the control limits it); `nothing-moves` (a warning
/// if the program only defines subprograms); `tool-mismatch`; `units-doubtful`; and `units-jump`
/// of the feeds and the stock. `end` is the state after the last block.
std::vector<core::Finding> implausible_findings(const PreparedCheck& check,
                                                const CheckRecord& record, const RunState& end,
                                                const core::Setup& setup);

} // namespace app

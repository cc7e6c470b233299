#pragma once

#include <string>
#include <vector>

#include "app/library/find/folder_walk.h"
#include "app/library/result/batch_result.h"

namespace app {

/// Level of detail and colour of the text about a batch.
struct BatchStyle {
    bool colour = false;
    bool quiet = false;   // only programs with an error, and the summary
    bool verbose = false; // also warnings, notes and assumptions, and every skipped file
};

/// The line of a finished program and the lines of its findings; empty if the style omits it.
std::string program_text(const ProgramResult& result, const BatchStyle& style);

/// The summary: verdicts, findings by rule, slowest programs, and what was not checked. `seconds`
/// is the total time; a negative value omits all times.
std::string batch_summary(const BatchResult& batch, double seconds, const BatchStyle& style);

/// In how many programs each thing was not described or only assumed: "fixtures in 24, axis limits
/// in 30: not described; stock in 30: assumed". Empty if everything was described.
std::string uncovered_summary(const BatchResult& batch);

/// All programs in order, and the summary without times.
std::string batch_text(const BatchResult& batch, const BatchStyle& style);

/// The number of findings of a rule with one severity.
struct RuleTally {
    core::Severity severity = core::Severity::off;
    std::string rule;
    size_t programs = 0, findings = 0;

    bool operator==(const RuleTally&) const = default;
};

/// Of one program; errors first, then by rule name.
std::vector<RuleTally> rule_tallies(const ProgramResult& program);

/// Of all programs, in that order.
std::vector<RuleTally> rule_tallies(const BatchResult& batch);

/// Files that were skipped for one reason.
struct SkippedGroup {
    std::string why;
    std::vector<std::string> files; // in their order
};

/// The skipped files by reason; the reason with most files first.
std::vector<SkippedGroup> skipped_groups(const std::vector<SkippedFile>& skipped);

} // namespace app

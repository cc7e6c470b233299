#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "app/library/result/program_diff.h"
#include "app/library/result/program_result.h"

namespace app {

/// The differences between two versions as text: blocks that came nearer, the worst first, then new
/// and resolved findings. `all` lists every block instead of the worst dozen.
std::string diff_text(const ProgramDiff& diff, bool all);

/// The differences as one JSON object, schema 1, with every block.
std::string diff_json(const ProgramDiff& diff);

/// "error near-miss, line 17: G0 X10.".
std::string finding_line(const StoredFinding& finding);

/// The findings (rule, severity, line, message and so on) in the format of a program's JSON result.
nlohmann::ordered_json findings_json(const std::vector<StoredFinding>& findings);

} // namespace app

#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "app/library/result/program_diff.h"
#include "app/library/result/program_result.h"

namespace app {

/// What became other between two versions, for a person: what came nearer, the worst first, then
/// findings that are new and gone. `all` gives every block, not the worst dozen.
std::string diff_text(const ProgramDiff& diff, bool all);

/// The same as one JSON object, schema 1, with every block.
std::string diff_json(const ProgramDiff& diff);

/// "error near-miss, line 17: G0 X10.".
std::string finding_line(const StoredFinding& finding);

/// Rule, severity, line, message and so on of each, as the JSON of a program's result has them.
nlohmann::ordered_json findings_json(const std::vector<StoredFinding>& findings);

} // namespace app

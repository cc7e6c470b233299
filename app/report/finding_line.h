#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "app/batch/program_result.h"

namespace app {

/// "error near-miss, line 17: G0 X10.".
std::string finding_line(const KeptFinding& finding);

/// Rule, severity, line, message and so on of each, as the JSON of a program's result has them.
nlohmann::ordered_json findings_json(const std::vector<KeptFinding>& findings);

} // namespace app

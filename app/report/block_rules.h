#pragma once

#include <map>

#include "app/session/check_run.h"

namespace app {

/// The rules of the findings about each block, the worst first, each once; also of those that
/// another finding tells of.
std::map<core::BlockIndex, std::vector<std::string>> rules_of_blocks(const CheckRun& run);

} // namespace app

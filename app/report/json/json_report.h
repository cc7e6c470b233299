#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/ids.h"

namespace app {

struct CheckRun;

/// The report of a check as JSON, schema 1. `pairs` adds every pair of every block.
std::string json_report(const CheckRun& run, bool pairs);

/// The same, an object to a line, so that a reader need not hold all of it: what is said of the
/// program, then its blocks, then its findings, then part and statistics. `record` tells them
/// apart: program, block, finding, end.
std::string json_lines_report(const CheckRun& run, bool pairs);

/// The rules of the findings about each block, the worst first, each once; also of those that
/// another finding tells of.
std::map<core::BlockIndex, std::vector<std::string>> rules_of_blocks(const CheckRun& run);

} // namespace app

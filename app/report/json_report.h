#pragma once

#include <string>

#include "app/session/check_run.h"

namespace app {

/// The report of a check as JSON, schema 1. `pairs` adds every pair of every block.
std::string json_report(const CheckRun& run, bool pairs);

/// The same, an object to a line, so that a reader need not hold all of it: what is said of the
/// program, then its blocks, then its findings, then part and statistics. `record` tells them
/// apart: program, block, finding, end.
std::string json_lines_report(const CheckRun& run, bool pairs);

} // namespace app

#pragma once

#include <string>

#include "app/session/check_run.h"

namespace app {

/// The report of a check as JSON, schema 1. `pairs` adds every pair of every block.
std::string json_report(const CheckRun& run, bool pairs);

} // namespace app

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/batch/watched_files.h"
#include "app/commands/commands.h"

namespace app {

/// Runs a check, and again whenever something on disk that it looked at changes, until Ctrl-C.
/// `pass` is told where to note the looks that are taken on other threads than its own; `outputs`
/// are the reports and results that it writes anew, or that are taken away. Returns what the last
/// pass did.
ExitCode watch(const std::vector<std::string>& outputs,
               const std::function<ExitCode(WatchedFiles&)>& pass);

} // namespace app

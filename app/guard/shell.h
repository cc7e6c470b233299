#pragma once

#include <string>

#include "core/base/result.h"

namespace app {

/// What a command has written to its standard output.
struct ShellOutput {
    std::string bytes;
    int status = 0; // 0: it succeeded
};

/// Runs a command of the shell with a file as its last argument, as LinuxCNC runs filters: COMMAND
/// 'FILE'. Its standard error stays that of this process.
///
/// Errors: unsupported if it cannot be started.
core::Result<ShellOutput> run_in_shell(const std::string& command, const std::string& file);

} // namespace app

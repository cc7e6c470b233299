#pragma once

#include <map>
#include <string>

#include "core/base/result.h"

namespace app {

/// The numbered parameters of a LinuxCNC variables file: a number and its value on each line.
///
/// Errors: io when it cannot be read; syntax, with its line, for one that says something else or a
///         number that no parameter has.
core::Result<std::map<int, double>> read_variables(const std::string& path);

} // namespace app

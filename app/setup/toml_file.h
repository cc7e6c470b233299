#pragma once

#include <string>

#include <toml++/toml.h>

#include "core/base/result.h"

namespace app {

/// A TOML file as a table.
///
/// Errors: io when there is no such file; syntax, with line and column.
core::Result<toml::table> read_toml(const std::string& path);

} // namespace app

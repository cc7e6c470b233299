#pragma once

#include <string>
#include <string_view>

#include <toml++/toml.h>

#include "core/base/result.h"

namespace app {

/// A text in TOML as a table.
///
/// Errors: syntax, with line and column.
core::Result<toml::table> parsed_toml(std::string_view text);

/// A TOML file as a table.
///
/// Errors: io when there is no such file; syntax, with line and column. All name the file.
core::Result<toml::table> read_toml(const std::string& path);

} // namespace app

#pragma once

#include <string>
#include <string_view>

#include <toml++/toml.h>

#include "core/base/result.h"

namespace app {

/// Parses TOML text.
///
/// Errors: syntax, with line and column.
core::Result<toml::table> parsed_toml(std::string_view text);

/// Reads a TOML file.
///
/// Errors: io if there is no such file; syntax, with line and column. All name the file.
core::Result<toml::table> read_toml(const std::string& path);

} // namespace app

#pragma once

#include <string>
#include <string_view>

namespace core {
struct Solid;
struct ToolDescription;
} // namespace core

namespace app {

struct SetupFile;

/// A number as TOML has it, to the last bit; whole ones stay whole.
std::string toml_number(double value);

/// A text as TOML has it: read again it is the same, or utf8_text of it.
std::string toml_text(std::string_view text);

/// A `[[tool]]` that is read as this tool, every number to its last bit.
std::string tool_table(const core::ToolDescription& tool);

/// A `[stock]` that is read as this box or cylinder; empty for a mesh, which has a file of its own.
std::string stock_table(const core::Solid& stock, std::string_view frame);

/// A set-up as a file that `check --setup` takes, with what was assumed as comments.
///
/// Result: every number to its last bit, so that the file means what the set-up means.
std::string setup_text(const SetupFile& setup, const std::string& program);

} // namespace app

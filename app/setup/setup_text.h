#pragma once

#include <string>
#include <string_view>

namespace core {
struct Solid;
struct ToolDescription;
} // namespace core

namespace app {

struct SetupFile;

/// A number in TOML, exact to the last bit; whole numbers are written without a fraction.
std::string toml_number(double value);

/// A text as a TOML string that gives the text when read, or its utf8_text.
std::string toml_text(std::string_view text);

/// A `[[tool]]` that gives this tool when read, exact to the last bit.
std::string tool_table(const core::ToolDescription& tool);

/// A `[stock]` that gives this box or cylinder when read; empty for a mesh, which needs a file.
std::string stock_table(const core::Solid& stock, std::string_view frame);

/// A set-up as a file for `check --setup`, with the assumptions as comments.
///
/// Result: numbers are exact to the last bit, so the file gives the same set-up when read.
std::string setup_text(const SetupFile& setup, const std::string& program);

} // namespace app

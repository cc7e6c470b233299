#pragma once

#include <string>
#include <string_view>

#include "app/setup/program_settings.h"
#include "core/base/ids.h"

namespace core {
struct ToolDescription;
} // namespace core

namespace app {

struct FoundTool;
struct SetupFile;

/// Where a set-up comes from.
struct SetupOrigin {
    std::string program; // path
    ProgramSettings settings{};
    std::string folder{}; // of the set-up file; empty: the current one
};

/// A text as a TOML string that gives the text when read, or its utf8_text.
std::string toml_text(std::string_view text);

/// A `[[tool]]` of a set-up in a unit that gives this tool when read: in mm exact to the last bit,
/// in inches rounded as by setup_length(), or exact where rounded lengths would contradict each
/// other.
std::string tool_table(const core::ToolDescription& exact, gcode::LengthUnit unit);

/// The lines of a `[[tool]]` without its header, which states what a source states of a tool. If
/// the source names the shape, sizes that are assumed are "unknown". Lengths are exact to the last
/// bit.
std::string found_tool_lines(const FoundTool& listed, gcode::LengthUnit unit);

/// Parts of a set-up file in its unit, each after an empty line, with assumed lines commented out.
/// A tool or a stock of which the file is to state nothing gives only comments; a part that no
/// document has gives nothing. `folder`: of the set-up file; empty: the current one.
std::string tool_text(const SetupFile& setup, core::ToolNumber number);
std::string stock_text(const SetupFile& setup, const std::string& folder);
std::string part_text(const SetupFile& setup, const std::string& folder);

/// The name of a work offset on the control of the program: "G505" on a Siemens control, else
/// "G58".
std::string offset_name(const SetupFile& setup, size_t index);

/// The work offset at whose origin the stock is mounted, if possible one of the program.
std::string stock_frame(const SetupFile& setup);

std::string offsets_header();
/// The line of a work offset, which is commented out.
std::string offset_line(const SetupFile& setup, size_t index);

/// A complete set-up as a file for `check --setup`. It states what the program and the options
/// state, and has assumptions and examples as lines that are commented out. So a check with it
/// completes it as it completes no set-up.
///
/// Result: lengths are in `length_unit` of the set-up, rounded as by setup_length(), and assumed
/// ones as by assumed_length().
std::string setup_text(const SetupFile& setup, const SetupOrigin& origin);

} // namespace app

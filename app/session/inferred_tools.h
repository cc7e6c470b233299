#pragma once

#include <map>

#include "app/session/program_survey.h"
#include "app/setup/setup_file.h"
#include "app/tools/found_tool.h"

namespace app {

/// Tools that the set-up lacks, by what its library, the program's comments and the control's table
/// say, in this order.
struct OfferedTools {
    std::map<core::ToolNumber, FoundTool> tools;
    std::optional<FoundTool> in_spindle; // of a program that calls no tool
};

/// Errors: of the tool table's file.
core::Result<OfferedTools> offered_tools(const SetupFile& file, const gcode::Program& program);

/// A tool of which only the use is known.
FoundTool unknown_tool(core::ToolNumber number, bool mills, gcode::LengthUnit unit);

/// Puts a tool in its place, completed by what such tools usually have. In a bare set-up the
/// control's length is its length.
///
/// Result: what is assumed.
std::string put_tool(SetupFile& file, const FoundTool& found, double least_flutes,
                     double control_length);

} // namespace app

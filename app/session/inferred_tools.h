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

/// Adds a tool that was found, completed by what such tools usually have.
void add_tool(SetupFile& file, const FoundTool& found);

/// Adds a tool of which only the use is known.
void add_unknown_tool(SetupFile& file, core::ToolNumber number, bool mills, gcode::LengthUnit unit);

} // namespace app

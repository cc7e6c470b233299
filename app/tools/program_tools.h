#pragma once

#include <map>

#include "app/tools/found_tool.h"
#include "gcode/dialect.h"
#include "gcode/source.h"

namespace app {

/// The unit in which a program writes its lengths: what it says first, else `otherwise`.
gcode::LengthUnit unit_of_program(const gcode::Program& program, gcode::LengthUnit otherwise);

/// The tools that the comments of a program describe, and Klartext's TOOL DEF, by their numbers.
///
/// Result: `in_spindle` is the tool of a program that calls none: it has no number of its own.
struct ProgramTools {
    std::map<core::ToolNumber, FoundTool> tools;
    std::optional<FoundTool> in_spindle;
};
ProgramTools tools_of_program(const gcode::Program& program, gcode::LengthUnit unit);

} // namespace app

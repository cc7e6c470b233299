#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/setup/tools/found_tool.h"
#include "app/setup/tools/tool_text.h"

namespace gcode {
enum class LengthUnit : uint8_t;
struct Environment;
struct Program;
} // namespace gcode

namespace app {

/// The unit of a program that states none, as far as its tools are concerned.
gcode::LengthUnit unit_at_start(const gcode::Environment& environment);

/// The length unit of a program: the first that it states, else `otherwise`.
gcode::LengthUnit unit_of_program(const gcode::Program& program, gcode::LengthUnit otherwise);

/// The tools that a program describes in comments and in Klartext's TOOL DEF, by number.
///
/// Result: `in_spindle` is the tool of a program without tool calls, which has no number.
struct ProgramTools {
    std::map<core::ToolNumber, FoundTool> tools;
    std::optional<FoundTool> in_spindle;
};
ProgramTools tools_of_program(const gcode::Program& program, gcode::LengthUnit unit);

/// What one comment says about a tool.
struct ToolComment {
    std::optional<int> number; // tool number; empty: the next tool called
    ToolText text;
    bool flank_angle = false; // text.angle_deg is the flank angle, not the angle of the whole tip
    bool whole = false;       // in a form that only tool lists use
};

/// Reads a comment, without its brackets, in the forms of CAM systems: Fusion 360 and HSM (T1 D=6.
/// CR=0. - ...), Mastercam (T1 | 1/2 FLAT ENDMILL | H1 ...; ... TOOL - 1 DIA. OFF. - 1 ... DIA. -
/// .5), Vectric (T1 = End Mill {6 mm}), CamBam (T1 : 6.0), Kiri:Moto (tool#=1 flute=6), CL data
/// (TOOL/MILL,3.175,0.), PyCAM (tool_radius = 3), tool lists (1 1 -1.2 0.25 name). Any other
/// comment is read as a tool name, with a number if it has one as in "Tool 8 = .250 Vee bit".
///
/// Units: numbers without a unit are in `unit`.
ToolComment read_tool_comment(std::string_view comment, gcode::LengthUnit unit);

/// A line of a program, split into code and comments.
struct LineParts {
    std::string code; // in capitals, without blanks
    std::vector<std::string> comments;
};

/// Comments are in round brackets, after a semicolon, and, where no word with a number can be, in
/// square brackets.
LineParts parts_of_line(std::string_view line);

} // namespace app

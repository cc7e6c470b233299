#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "app/tools/tool_text.h"

namespace app {

/// What one comment of a program says about a tool.
struct ToolComment {
    std::optional<int> number; // of the tool; else of the one that is called next
    ToolText text;
    bool flank_angle = false; // text.angle_deg is that of a flank, not of a whole tip
    bool whole = false;       // in a form that only lists of tools have
};

/// Reads a comment, without its brackets, in the forms of CAM systems: Fusion 360 and HSM (T1 D=6.
/// CR=0. - ...), Mastercam (T1 | 1/2 FLAT ENDMILL | H1 ...; ... TOOL - 1 DIA. OFF. - 1 ... DIA. -
/// .5), Vectric (T1 = End Mill {6 mm}), CamBam (T1 : 6.0), Kiri:Moto (tool#=1 flute=6), CL data
/// (TOOL/MILL,3.175,0.), PyCAM (tool_radius = 3), tool lists (1 1 -1.2 0.25 name); else whatever a
/// name says, with a number if it has one as in "Tool 8 = .250 Vee bit".
///
/// Units: numbers without a unit are in `unit`.
ToolComment read_tool_comment(std::string_view comment, gcode::LengthUnit unit);

} // namespace app

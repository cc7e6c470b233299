#pragma once

#include <optional>
#include <string_view>

#include "core/sim/tool_description.h"
#include "gcode/modal_state.h"

namespace app {

/// What a tool's name says about it, as people and CAM systems write such names.
struct ToolText {
    std::optional<core::ToolShape> shape;
    std::optional<double> diameter; // mm
    bool stated = false;            // the diameter is named as one, as in D=6 or DIA. 6
    bool sized = false;             // or has a unit, or is a fraction or a drill's number
    bool pointed = false;           // or is at least no whole number
    bool prose = false;             // a sentence that does not say "10 mm ball" or the like
    size_t words = 0;
    std::optional<double> corner_radius, flute_length, stick_out, pitch, tip_diameter;
    std::optional<double> angle_deg; // as written: of a flank, a point or the whole tip
};

/// Reads "1/2 FLAT ENDMILL", "End Mill {6 mm}", "10MM X 90DEG CRB SPOT DRILL", "DRILL #4".
///
/// Units: numbers without a unit are in `unit`; fractions are inches.
ToolText read_tool_text(std::string_view text, gcode::LengthUnit unit);

/// The tool a name describes; empty when it does not say what the tool is, or how wide.
std::optional<core::ToolDescription> tool_of_text(const ToolText& text);

} // namespace app

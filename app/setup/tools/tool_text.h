#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/sim/tool_description.h"

namespace gcode {
enum class LengthUnit : uint8_t;
}

namespace app {

/// A number in a text with what stands right before and behind it.
struct TextNumber {
    std::string prefix; // letters without a blank between, or the word before with = or :
    double value = 0.0;
    bool fraction = false;
    bool has_point = false; // or is a fraction
    std::string suffix;     // letters, a degree or inch sign, or the word that follows
    bool glued = false;     // the suffix has no blank before it
};

/// The text in capitals, with the signs for degree, diameter and inch as words.
std::string plain_capitals(std::string_view text);

/// All numbers of a text in capitals, "1/2" and "1-1/2" as one. Numbers within words such as
/// catalogue numbers are left out.
std::vector<TextNumber> numbers_of(const std::string& capitals);

/// What kind of tool the words of a text in capitals name.
std::optional<core::ToolShape> shape_of_words(const std::string& capitals);

/// Whether a text in capitals names what cuts nothing, as a probe.
bool names_no_cutter(const std::string& capitals);

/// Whether a text in capitals is a part of a sentence, where sizes may be those of anything.
bool is_prose(const std::string& capitals);

/// Whether a size stands right before a word for a tool: "10MM BALL", "1/2 END MILL".
bool names_sized_tool(const std::string& capitals);

size_t words_in(const std::string& text);

/// The diameter of a drill by its number, 1 to 60, in inches.
std::optional<double> numbered_drill(int number);

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

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

/// A number in a text, with the text directly before and after it.
struct TextNumber {
    std::string prefix; // adjacent letters, or the preceding word with = or :
    double value = 0.0;
    bool fraction = false;
    bool has_point = false; // has a decimal point or is a fraction
    std::string suffix;     // letters, a degree or inch sign, or the next word
    bool glued = false;     // the suffix has no blank before it
};

/// The text in capitals, with degree, diameter and inch signs as words.
std::string plain_capitals(std::string_view text);

/// All numbers of a text in capitals, with "1/2" and "1-1/2" as one number. Excludes numbers within
/// words, such as catalogue numbers.
std::vector<TextNumber> numbers_of(const std::string& capitals);

/// The kind of tool named in a text in capitals.
std::optional<core::ToolShape> shape_of_words(const std::string& capitals);

/// Whether a text in capitals names something that does not cut, such as a probe.
bool names_no_cutter(const std::string& capitals);

/// Whether a text in capitals is part of a sentence, whose sizes may refer to anything.
bool is_prose(const std::string& capitals);

/// Whether a size directly precedes a word for a tool: "10MM BALL", "1/2 END MILL".
bool names_sized_tool(const std::string& capitals);

size_t words_in(const std::string& text);

/// The diameter of a numbered drill, 1 to 60, in inches.
std::optional<double> numbered_drill(int number);

/// What a tool's name says, in the style of people and CAM systems.
struct ToolText {
    std::optional<core::ToolShape> shape;
    std::optional<double> diameter; // mm
    bool stated = false;            // the diameter is labelled, as in D=6 or DIA. 6
    bool sized = false;             // labelled, with a unit, a fraction or a drill number
    bool pointed = false;           // with a decimal point or a fraction
    bool prose = false;             // a sentence without a phrase such as "10 mm ball"
    size_t words = 0;
    std::optional<double> corner_radius, flute_length, stick_out, pitch, tip_diameter;
    std::optional<double> angle_deg; // as written: flank, point or whole tip
};

/// Reads "1/2 FLAT ENDMILL", "End Mill {6 mm}", "10MM X 90DEG CRB SPOT DRILL", "DRILL #4".
///
/// Units: numbers without a unit are in `unit`; fractions are inches.
ToolText read_tool_text(std::string_view text, gcode::LengthUnit unit);

/// The tool that a name describes; empty if it lacks the kind or the diameter.
std::optional<core::ToolDescription> tool_of_text(const ToolText& text);

} // namespace app

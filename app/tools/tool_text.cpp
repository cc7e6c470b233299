#include "app/tools/tool_text.h"

#include <string>

#include "app/tools/tool_words.h"

namespace app {
namespace {

using core::ToolShape;
using gcode::LengthUnit;

bool is_one_of(const std::string& word, std::initializer_list<const char*> words) {
    for (const char* each : words)
        if (word == each) return true;
    return false;
}

double in_mm(const TextNumber& number, LengthUnit unit) {
    if (number.suffix == "MM") return number.value;
    const bool inches =
        number.fraction || is_one_of(number.suffix, {"IN", "INCH", "INCHES", "\"", "ZOLL"});
    return gcode::to_mm(number.value, inches ? LengthUnit::inch : unit);
}

bool is_angle(const TextNumber& number) {
    return is_one_of(number.suffix, {"DEG", "DEGREE", "DEGREES", "GRAD"})
           || is_one_of(number.prefix, {"TAPER", "ANGLE"});
}

bool has_length_unit(const TextNumber& number) {
    return number.fraction
           || is_one_of(number.suffix, {"MM", "IN", "INCH", "INCHES", "\"", "ZOLL"});
}

/// Letters that run on from a number and are no unit make it a part of a word; so do those of
/// counts.
bool says_something_else(const TextNumber& number) {
    const bool unit =
        has_length_unit(number) || is_one_of(number.suffix, {"X", "DIA", "D", "RAD", "R"});
    if (number.glued && !unit) return true;
    return is_one_of(number.suffix, {"FL", "FLUTE", "FLUTES", "FLT", "Z", "RPM"})
           || is_one_of(number.prefix, {"T", "H", "TOOL", "OFF",    "LEN",   "ZMIN",   "ZMAX", "Z",
                                        "S", "F", "N",    "M",      "STOCK", "NUMBER", "WEAR", "OP",
                                        "O", "L", "C",    "LENGTH", "P",     "FEED"});
}

void take_size(const TextNumber& number, double size, ToolText& text,
               std::optional<double>& first) {
    first = size;
    text.sized = has_length_unit(number) || number.prefix == "#";
    text.pointed = number.has_point;
}

void read_number(const TextNumber& number, LengthUnit unit, ToolText& text,
                 std::optional<double>& named, std::optional<double>& first) {
    const double size = in_mm(number, unit);
    if (is_angle(number)) {
        if (!text.angle_deg) text.angle_deg = number.value;
    } else if (number.suffix == "LOC" || number.prefix == "LOC"
               || (number.prefix == "LEN" && !text.flute_length && first)) {
        text.flute_length = size;
    } else if (number.prefix == "TIP") {
        text.tip_diameter = size;
    } else if (number.prefix == "EXT") {
        text.stick_out = size;
    } else if (is_one_of(number.prefix, {"CR", "R", "RAD", "RADIUS"})
               || is_one_of(number.suffix, {"RAD", "R", "RADIUS", "CR"})) {
        text.corner_radius = size;
    } else if (is_one_of(number.prefix, {"D", "DIA", "DIAM", "DIAMETER"})) {
        named = size;
    } else if (is_one_of(number.suffix, {"DIA", "DIAM", "DIAMETER"})) {
        named = size;
    } else if (number.prefix == "#") {
        const auto drill = numbered_drill(static_cast<int>(number.value));
        if (drill && !first) take_size(number, gcode::to_mm(*drill, LengthUnit::inch), text, first);
    } else if (number.prefix == "PITCH") {
        text.pitch = size;
    } else if (!says_something_else(number) && !first) {
        take_size(number, size, text, first);
    }
}

/// Angles as catalogues have them: of the whole tip for drills and V-bits, of the flank in posts.
void place_angle(const ToolText& text, core::ToolDescription& tool) {
    if (!text.angle_deg) return;
    const double angle = *text.angle_deg;
    if (tool.shape == ToolShape::drill) tool.point_deg = angle;
    if (tool.shape == ToolShape::taper || tool.shape == ToolShape::dovetail) tool.angle_deg = angle;
    if (tool.shape == ToolShape::chamfer) tool.angle_deg = 0.5 * angle;
}

} // namespace

ToolText read_tool_text(std::string_view words, gcode::LengthUnit unit) {
    const std::string capitals = plain_capitals(words);
    ToolText text;
    if (names_no_cutter(capitals)) return text;
    text.shape = shape_of_words(capitals);
    std::optional<double> named, first;
    const std::vector<TextNumber> numbers = numbers_of(capitals);
    bool registers = false; // beside an H, a D is the number of an offset
    for (const TextNumber& number : numbers) registers = registers || number.prefix == "H";
    for (const TextNumber& number : numbers)
        if (!registers || number.prefix != "D") read_number(number, unit, text, named, first);
    text.stated = named.has_value();
    text.sized = text.sized || text.stated;
    text.words = words_in(capitals);
    text.prose = is_prose(capitals) && !names_sized_tool(capitals);
    text.diameter = named ? named : first;
    return text;
}

std::optional<core::ToolDescription> tool_of_text(const ToolText& text) {
    if (!text.shape || !text.diameter) return std::nullopt;
    constexpr double least = 0.05, most = 500.0; // mm; beyond, the number means something else
    if (!(*text.diameter >= least && *text.diameter <= most)) return std::nullopt;
    core::ToolDescription tool;
    tool.shape = *text.shape;
    tool.diameter = *text.diameter;
    const double corner = text.corner_radius.value_or(0.0), r = 0.5 * tool.diameter;
    if (tool.shape == ToolShape::flat && corner > 0.0 && corner < r) tool.shape = ToolShape::bull;
    if (tool.shape == ToolShape::bull && corner > 0.0 && corner <= r) tool.corner_radius = corner;
    tool.flute_length = text.flute_length.value_or(0.0);
    tool.stick_out = text.stick_out;
    const bool tipped = tool.shape == ToolShape::taper || tool.shape == ToolShape::chamfer;
    if (tipped && text.tip_diameter.value_or(0.0) < tool.diameter)
        tool.tip_diameter = text.tip_diameter.value_or(0.0);
    if (tool.shape == ToolShape::threadmill) tool.pitch = text.pitch;
    place_angle(text, tool);
    return tool;
}

} // namespace app

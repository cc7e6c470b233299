#include "app/tools/tool_comment.h"

#include <array>
#include <charconv>
#include <regex>

#include "app/tools/tool_words.h"

namespace app {
namespace {

using core::ToolShape;
using gcode::LengthUnit;

constexpr auto style = std::regex::ECMAScript | std::regex::optimize;
const char* const number_text = R"(([0-9]*\.?[0-9]+|[0-9]+\.?))";

std::regex pattern(std::string text) {
    for (size_t at = text.find("<N>"); at != std::string::npos; at = text.find("<N>", at))
        text.replace(at, 3, number_text);
    return std::regex(text, style);
}

double number_of(const std::string& text) {
    double value = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

int whole_of(const std::string& text) {
    int value = -1;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

/// A form of comment: its pattern in capitals, and what is read from a match.
struct Form {
    std::regex pattern;
    void (*read)(const std::smatch& match, LengthUnit unit, ToolComment& comment);
};

void read_fusion(const std::smatch& m, LengthUnit unit, ToolComment& comment) {
    comment.number = whole_of(m[1]);
    comment.text = read_tool_text(m[5].str(), unit);
    comment.text.diameter = gcode::to_mm(number_of(m[2]), unit);
    comment.text.stated = comment.whole = true;
    if (m[3].matched) comment.text.corner_radius = gcode::to_mm(number_of(m[3]), unit);
    if (m[4].matched) comment.text.angle_deg = number_of(m[4]);
    comment.flank_angle = m[5].str().find("COUNTER") == std::string::npos;
}

void read_mastercam(const std::smatch& m, LengthUnit unit, ToolComment& comment) {
    static const std::regex stated = pattern(R"(TOOL DIA\.? *-? *<N>)");
    comment.number = whole_of(m[1]);
    comment.text = read_tool_text(m[2].str(), unit);
    comment.whole = true;
    const std::string rest = m[3];
    std::smatch diameter;
    if (std::regex_search(rest, diameter, stated))
        comment.text.diameter = gcode::to_mm(number_of(diameter[1]), unit);
}

void read_old_mastercam(const std::smatch& m, LengthUnit unit, ToolComment& comment) {
    comment.text = read_tool_text(m[1].str(), unit);
    comment.number = whole_of(m[2]);
    comment.text.diameter = gcode::to_mm(number_of(m[3]), unit);
    comment.text.stated = comment.whole = true;
}

void read_cambam(const std::smatch& m, LengthUnit unit, ToolComment& comment) {
    comment.number = whole_of(m[1]);
    comment.text.diameter = gcode::to_mm(number_of(m[2]), unit);
    comment.whole = true;
}

void read_kiri(const std::smatch& m, LengthUnit, ToolComment& comment) {
    const LengthUnit unit = m[4].str().starts_with("METRIC") ? LengthUnit::mm : LengthUnit::inch;
    comment.number = whole_of(m[1]);
    comment.text.diameter = gcode::to_mm(number_of(m[2]), unit);
    comment.whole = true;
}

void read_cl_data(const std::smatch& m, LengthUnit unit, ToolComment& comment) {
    const double diameter = number_of(m[2]), corner = number_of(m[3]);
    comment.text.diameter = gcode::to_mm(diameter, unit);
    comment.text.stated = comment.text.sized = true;
    comment.text.shape = m[1] == "DRILL" ? ToolShape::drill : ToolShape::flat;
    if (corner > 0.0) comment.text.corner_radius = gcode::to_mm(corner, unit);
    if (corner > 0.0 && 2.0 * corner >= 0.999 * diameter) comment.text.shape = ToolShape::ball;
}

void read_list_row(const std::smatch& m, LengthUnit unit, ToolComment& comment) {
    comment.number = whole_of(m[1]);
    comment.text = read_tool_text(m[4].str(), unit);
    comment.text.diameter = gcode::to_mm(number_of(m[3]), unit);
    comment.whole = true;
}

void read_numbered(const std::smatch& m, LengthUnit unit, ToolComment& comment) {
    comment.number = whole_of(m[1]);
    comment.text = read_tool_text(m[2].str(), unit);
    const bool sure = comment.text.sized || comment.text.pointed || comment.text.words <= 4;
    comment.whole = comment.text.shape && comment.text.diameter && sure;
}

void read_name_first(const std::smatch& m, LengthUnit unit, ToolComment& comment) {
    comment.number = whole_of(m[2]);
    comment.text = read_tool_text(m[1].str(), unit);
}

const std::vector<Form>& forms() {
    static const std::vector<Form> all = {
        {pattern(R"(^ *T *([0-9]+) +D=<N>(?: +CR=<N>)?(?: +TAPER=<N> *DEG)?(.*)$)"), read_fusion},
        {pattern(R"(^ *(?:TOOL *)?T? *#?([0-9]+) *\|([^|]*)(.*)$)"), read_mastercam},
        {pattern(R"(^(.*)TOOL *- *([0-9]+) +DIA\. *OFF\..* DIA\. *- *<N> *$)"), read_old_mastercam},
        {pattern(R"(^ *T *([0-9]+) *: *<N> *$)"), read_cambam},
        {pattern(R"(^ *TOOL#=([0-9]+) +FLUTE=<N> +LEN=<N>.*UNIT=([A-Z]+).*$)"), read_kiri},
        {pattern(R"(^ *TOOL/(MILL|DRILL)[, .] *<N>[, .]+ *<N>.*$)"), read_cl_data},
        {pattern(R"(^ *[0-9]+ +([0-9]+) +-?<N> +<N> +(.*)$)"), read_list_row},
        {pattern(R"(^ *T *([0-9]+)(?: *[=:-] *|  *)(.*)$)"), read_numbered},
        {pattern(R"(^.*\bTOOL *(?:NUMBER|NO\.?|NR\.?)? *#?[=:]? *([0-9]+)(?: *[=:-] *|  *)(.*)$)"),
         read_numbered},
        {pattern(R"(^ *([0-9]+) *= *(.*)$)"), read_numbered},
        {pattern(R"(^(.*)\bTOOL *(?:NUMBER|NO\.?|NR\.?)? *#?[=:]? *([0-9]+) *$)"),
         read_name_first}};
    return all;
}

/// What stands alone on its line in headers of some systems: a key and a value.
void read_key_and_value(const std::string& capitals, LengthUnit unit, ToolComment& comment) {
    static const std::regex diameter = pattern(
        R"(^[ *]*(?:TOOL|CUTTER|END ?MILL|BIT) *(DIAMETER|DIA\.?|RADIUS) *[=:]? *<N>(.*)$)");
    static const std::regex number = pattern(R"(^[ *]*TOOL *NUMBER *[=:]? *([0-9]+)[ *]*$)");
    std::smatch m;
    if (std::regex_match(capitals, m, diameter)) {
        const double size = number_of(m[2]) * (m[1] == "RADIUS" ? 2.0 : 1.0);
        const bool inch = m[3].str().find("IN") != std::string::npos;
        const bool mm = m[3].str().find("MM") != std::string::npos;
        comment.text = {};
        comment.number.reset();
        comment.text.diameter = gcode::to_mm(size, inch ? LengthUnit::inch
                                                   : mm ? LengthUnit::mm
                                                        : unit);
        comment.text.stated = comment.text.sized = true;
    } else if (std::regex_match(capitals, m, number)) {
        comment.text = {};
        comment.number = whole_of(m[1]);
    }
}

} // namespace

ToolComment read_tool_comment(std::string_view words, LengthUnit unit) {
    constexpr size_t longest = 200; // no tool's name is longer, and no pattern should see more
    ToolComment comment;
    if (words.size() > longest) return comment;
    std::string capitals(words);
    for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    for (char& c : capitals)
        if (c == '_' || c == '\t') c = ' ';
    std::smatch match;
    bool read = false;
    for (const Form& form : forms()) {
        if (!std::regex_match(capitals, match, form.pattern)) continue;
        form.read(match, unit, comment);
        read = true;
        break;
    }
    if (!read) comment.text = read_tool_text(words, unit);
    read_key_and_value(capitals, unit, comment);
    return comment;
}

} // namespace app

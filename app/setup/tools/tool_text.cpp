#include "app/setup/tools/tool_text.h"

#include <array>
#include <cctype>
#include <charconv>
#include <regex>
#include <string>
#include <utility>

#include "app/setup/tools/found_tool.h"
#include "core/base/text.h"
#include "gcode/language/modal_state.h"

namespace app {
namespace {

using core::ToolShape;

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

void replace_all(std::string& text, std::string_view what, std::string_view by) {
    for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
}

/// Reads a number without a sign at `at`, and moves `at` past it.
std::optional<double> plain_number(const std::string& text, size_t& at) {
    const size_t first = at;
    size_t end = at;
    while (end < text.size() && (is_digit(text[end]) || text[end] == '.')) ++end;
    double value = 0.0;
    const char* const from = text.data() + first;
    const auto [rest, failure] = std::from_chars(from, text.data() + end, value);
    if (failure != std::errc() || rest != text.data() + end) return std::nullopt;
    at = end;
    return value;
}

/// Adds "/2" after a whole number, or "-1/2" or " 1/2" after whole inches.
void add_fraction(const std::string& text, size_t& at, TextNumber& number) {
    size_t next = at;
    double over = number.value, whole = 0.0;
    if (next + 1 < text.size() && (text[next] == '-' || text[next] == ' ')
        && is_digit(text[next + 1])) {
        ++next;
        const auto value = plain_number(text, next);
        if (!value) return;
        whole = number.value;
        over = *value;
    }
    if (next + 1 >= text.size() || text[next] != '/' || !is_digit(text[next + 1])) return;
    ++next;
    const auto under = plain_number(text, next);
    if (!under || *under <= 0.0 || whole != static_cast<int>(whole)) return;
    number.value = whole + over / *under;
    number.fraction = true;
    at = next;
}

/// Reads the letters after a number, or the next word after a blank.
void add_suffix(const std::string& text, size_t at, TextNumber& number) {
    number.glued = at < text.size() && (is_letter(text[at]) || text[at] == '"');
    while (at < text.size() && text[at] == ' ') ++at;
    if (at < text.size() && text[at] == '"') {
        number.suffix = "\"";
        return;
    }
    while (at < text.size() && is_letter(text[at])) number.suffix += text[at++];
}

/// The letters directly before a number, skipping "=", ":", ".", "#", blanks and a minus sign.
std::string prefix_before(const std::string& text, size_t at) {
    while (at > 0
           && (text[at - 1] == ' ' || text[at - 1] == '=' || text[at - 1] == ':'
               || text[at - 1] == '.' || text[at - 1] == '#'
               || (text[at - 1] == '-' && at > 1 && text[at - 2] == ' ')))
        --at;
    size_t first = at;
    while (first > 0 && is_letter(text[first - 1])) --first;
    return text.substr(first, at - first);
}

/// Whether a number begins inside a word, as in ERP412 or C40-32, and so does not count. Letters
/// that name a size may directly precede it.
bool begins_inside_a_word(const std::string& text, size_t at) {
    if (at == 0) return false;
    const char before = text[at - 1];
    if (before == '.' || is_digit(before)) return true;
    if (before == '-') return at > 1 && text[at - 2] != ' ';
    if (!is_letter(before)) return false;
    size_t first = at;
    while (first > 0 && (is_letter(text[first - 1]) || is_digit(text[first - 1]))) --first;
    const std::string word = text.substr(first, at - first);
    for (const char* size : {"D", "R", "CR", "DIA", "L", "P", "M"})
        if (word == size) return false;
    return true;
}

} // namespace

std::string plain_capitals(std::string_view text) {
    std::string capitals(text);
    replace_all(capitals, "\xC2\xB0", " DEG "); // degree sign
    replace_all(capitals, "\xC3\x98", " DIA "); // O with stroke
    replace_all(capitals, "\xC3\xB8", " DIA ");
    replace_all(capitals, "\xE2\x8C\x80", " DIA ");
    for (char& c : capitals) {
        c = core::upper(c);
        if (c == ',') c = '.';
        if (c == '_' || c == '{' || c == '}' || c == '[' || c == ']' || c == '\t') c = ' ';
    }
    return capitals;
}

std::vector<TextNumber> numbers_of(const std::string& capitals) {
    std::vector<TextNumber> numbers;
    for (size_t at = 0; at < capitals.size();) {
        const bool starts =
            is_digit(capitals[at])
            || (capitals[at] == '.' && at + 1 < capitals.size() && is_digit(capitals[at + 1]));
        const size_t first = at;
        if (!starts) {
            ++at;
            continue;
        }
        TextNumber number;
        const auto value = plain_number(capitals, at);
        if (!value) {
            while (at < capitals.size() && (is_digit(capitals[at]) || capitals[at] == '.')) ++at;
            continue;
        }
        number.value = *value;
        number.has_point = capitals.substr(first, at - first).find('.') != std::string::npos;
        add_fraction(capitals, at, number);
        number.has_point = number.has_point || number.fraction;
        if (begins_inside_a_word(capitals, first)) continue;
        number.prefix = prefix_before(capitals, first);
        if (first > 0 && capitals[first - 1] == '#') number.prefix = "#";
        add_suffix(capitals, at, number);
        numbers.push_back(std::move(number));
    }
    return numbers;
}

std::optional<ToolShape> shape_of_words(const std::string& capitals) {
    const std::string text = " " + capitals + " ";
    for (const auto& [word, shape] : shape_words()) {
        if (text.find(word) != std::string::npos) return shape;
    }
    return std::nullopt;
}

bool names_no_cutter(const std::string& capitals) {
    for (const char* word : {"PROBE", "TASTER", "LASER", "KNIFE", "PLASMA", "EDGE FINDER"})
        if (capitals.find(word) != std::string::npos) return true;
    return false;
}

bool is_prose(const std::string& capitals) {
    const std::string text = " " + capitals + " ";
    for (const char* word :
         {" THE ", " A ",    " AN ",     " TO ",  " FOR ",  " NOT ",  " IS ", " THAN ",
          " BE ",  " OF ",   " AND ",    " ARE ", " THIS ", " THAT ", " IN ", " ON ",
          " AT ",  " FROM ", " CIRCLE ", " IF ",  "(=",     "<",      "#<",   "%"})
        if (text.find(word) != std::string::npos) return true;
    return capitals.starts_with("=");
}

bool names_sized_tool(const std::string& capitals) {
    static const std::regex sized(
        R"([0-9.] *(?:MM|IN|INCH|")? *(?:DIA[A-Z.]* *)?(?:FLAT *|CARBIDE *)?)"
        R"((?:END ?MILL|ENDMILL|BALL|BULL|CUTTER|DRILL|TOOL|BIT|V-?BIT|)"
        R"(ROUTER|FACE ?MILL|SLOT ?DRILL))");
    return std::regex_search(capitals, sized);
}

size_t words_in(const std::string& text) {
    size_t words = 0;
    bool inside = false;
    for (const char c : text) {
        const bool letter = is_letter(c) || is_digit(c);
        words += letter && !inside;
        inside = letter || (inside && c != ' ');
    }
    return words;
}

std::optional<double> numbered_drill(int number) {
    constexpr std::array<double, 60> inches = {
        .2280, .2210, .2130, .2090, .2055, .2040, .2010, .1990, .1960, .1935, .1910, .1890,
        .1850, .1820, .1800, .1770, .1730, .1695, .1660, .1610, .1590, .1570, .1540, .1520,
        .1495, .1470, .1440, .1405, .1360, .1285, .1200, .1160, .1130, .1110, .1100, .1065,
        .1040, .1015, .0995, .0980, .0960, .0935, .0890, .0860, .0820, .0810, .0785, .0760,
        .0730, .0700, .0670, .0635, .0595, .0550, .0520, .0465, .0430, .0420, .0410, .0400};
    if (number < 1 || number > static_cast<int>(inches.size())) return std::nullopt;
    return inches[static_cast<size_t>(number - 1)];
}

namespace {

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

/// Whether a number is not a diameter: directly followed by letters that are not a unit, or
/// labelled as a count, an offset or the like.
bool says_something_else(const TextNumber& number) {
    const bool unit =
        has_length_unit(number) || is_one_of(number.suffix, {"X", "DIA", "D", "RAD", "R"});
    if (number.glued && !unit) return true;
    return is_one_of(number.suffix, {"FL", "FLUTE", "FLUTES", "FLT", "Z", "RPM", "DEEP", "DEPTH",
                                     "THICK", "HOLES"})
           || is_one_of(number.prefix, {"T", "H", "TOOL", "OFF",    "LEN",   "ZMIN",   "ZMAX", "Z",
                                        "S", "F", "N",    "M",      "STOCK", "NUMBER", "WEAR", "OP",
                                        "O", "L", "C",    "LENGTH", "P",     "FEED",   "DEPTH"});
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

/// Assigns an angle as catalogues give it: of the whole tip for drills and V-bits, of the flank for
/// tapers and dovetails.
void assign_angle(const ToolText& text, core::ToolDescription& tool) {
    if (!text.angle_deg) return;
    const double angle = *text.angle_deg;
    if (has_size(tool.shape, &core::ToolDescription::point_deg)) tool.point_deg = angle;
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
    bool registers = false; // next to an H, a D is an offset number
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
    constexpr double least = 0.05, most = 500.0; // mm; other numbers are not diameters
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
    if (has_size(tool.shape, &core::ToolDescription::pitch)) tool.pitch = text.pitch;
    assign_angle(text, tool);
    return tool;
}

} // namespace app

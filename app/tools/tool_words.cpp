#include "app/tools/tool_words.h"

#include <array>
#include <cctype>
#include <charconv>
#include <regex>
#include <utility>

namespace app {
namespace {

using core::ToolShape;

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

void replace_all(std::string& text, std::string_view what, std::string_view by) {
    for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
}

/// Words in the order in which they count: "BALL END MILL" is no flat end mill.
constexpr std::pair<std::string_view, ToolShape> shape_words[] = {
    {"LOLLIPOP", ToolShape::lollipop},
    {"DOVETAIL", ToolShape::dovetail},
    {"DOVE MILL", ToolShape::dovetail},
    {"T-SLOT", ToolShape::tslot},
    {"TSLOT", ToolShape::tslot},
    {"T SLOT", ToolShape::tslot},
    {"SLOT MILL", ToolShape::tslot},
    {"SLITTING", ToolShape::tslot},
    {"WOODRUFF", ToolShape::tslot},
    {"KEY CUTTER", ToolShape::tslot},
    {"THREAD", ToolShape::threadmill},
    {"THRD", ToolShape::threadmill},
    {"TAPERED", ToolShape::taper},
    {"TAPER MILL", ToolShape::taper},
    {"TAPER END", ToolShape::taper},
    {"TPR MILL", ToolShape::taper},
    {"BULL", ToolShape::bull},
    {"TORUS", ToolShape::bull},
    {"TOROID", ToolShape::bull},
    {"BALL", ToolShape::ball},
    {"SPHER", ToolShape::ball},
    {"KUGEL", ToolShape::ball},
    {"V-BIT", ToolShape::chamfer},
    {"VBIT", ToolShape::chamfer},
    {"V BIT", ToolShape::chamfer},
    {"VEE", ToolShape::chamfer},
    {"V-CARV", ToolShape::chamfer},
    {"V-CUT", ToolShape::chamfer},
    {"V-GROOVE", ToolShape::chamfer},
    {"ENGRAV", ToolShape::chamfer},
    {"CHAM", ToolShape::chamfer},
    {"COUNTERSINK", ToolShape::chamfer},
    {"COUNTER SINK", ToolShape::chamfer},
    {"CSINK", ToolShape::chamfer},
    {"SLOT DRILL", ToolShape::flat},
    {"DRILL", ToolShape::drill},
    {"DRL", ToolShape::drill},
    {"BOHRER", ToolShape::drill},
    {"END MILL", ToolShape::flat},
    {"ENDMILL", ToolShape::flat},
    {"END-MILL", ToolShape::flat},
    {"FACE MILL", ToolShape::flat},
    {"FACEMILL", ToolShape::flat},
    {"SHELL MILL", ToolShape::flat},
    {"FLAT", ToolShape::flat},
    {"CYLIND", ToolShape::flat},
    {"ROUTER", ToolShape::flat},
    {"UPCUT", ToolShape::flat},
    {"DOWNCUT", ToolShape::flat},
    {"COMPRESSION", ToolShape::flat},
    {"REAM", ToolShape::flat},
    {"BORING", ToolShape::flat},
    {"BORE", ToolShape::flat},
    {"CUTTER", ToolShape::flat},
    {"FREZ", ToolShape::flat},
    {"FRAES", ToolShape::flat},
    {"FRESA", ToolShape::flat},
    {"FL ", ToolShape::flat},
    {"FLUTE", ToolShape::flat},
    {"EM ", ToolShape::flat},
    {" TAP", ToolShape::flat},
    {"MILL", ToolShape::flat}};

/// From `at`, a number without a sign; moves `at` behind it.
std::optional<double> plain_number(const std::string& text, size_t& at) {
    const size_t first = at;
    size_t end = at;
    while (end < text.size() && (is_digit(text[end]) || text[end] == '.')) ++end;
    double value = 0.0;
    const char* const from = text.data() + first;
    const auto [behind, failure] = std::from_chars(from, text.data() + end, value);
    if (failure != std::errc() || behind != text.data() + end) return std::nullopt;
    at = end;
    return value;
}

/// "/2" behind a whole number, or "-1/2" and " 1/2" behind the inches.
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

/// Letters behind a number; the next word if a blank is between.
void add_suffix(const std::string& text, size_t at, TextNumber& number) {
    number.glued = at < text.size() && (is_letter(text[at]) || text[at] == '"');
    while (at < text.size() && text[at] == ' ') ++at;
    if (at < text.size() && text[at] == '"') {
        number.suffix = "\"";
        return;
    }
    while (at < text.size() && is_letter(text[at])) number.suffix += text[at++];
}

/// The letters right before a number, over one = or : or blank-free dot between.
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

/// A number that begins in the middle of a word, as in ERP412 or C40-32, is none; letters that
/// name a size may stand right before it.
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
        c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
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
    for (const auto& [word, shape] : shape_words) {
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

} // namespace app

#include "app/setup/tools/program_tools.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <deque>
#include <regex>

#include <fmt/format.h>

#include "app/setup/tools/tool_text.h"
#include "core/base/math.h"
#include "core/base/text.h"
#include "core/base/units.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/language/lexer.h"
#include "gcode/language/modal_state.h"
#include "gcode/text/source.h"

namespace app {
namespace {

using core::ToolNumber;
using core::ToolShape;

/// The whole number at a position in a text.
std::optional<int> whole_at(const std::string& text, size_t at) {
    int value = 0;
    const auto [after_number, failure] =
        std::from_chars(text.data() + at, text.data() + text.size(), value);
    if (failure != std::errc() || after_number == text.data() + at) return std::nullopt;
    return value;
}

/// The tool that a block calls or defines.
std::optional<int> tool_called(const std::string& code) {
    for (const char* words : {"TOOLCALL", "TOOLDEF"})
        if (const size_t at = code.find(words); at != std::string::npos)
            return whole_at(code, at + std::string(words).size());
    for (size_t at = code.find('T'); at != std::string::npos; at = code.find('T', at + 1)) {
        if (at > 0 && !gcode::is_digit(code[at - 1]) && code[at - 1] != '.') continue;
        const size_t value = at + 1 + (at + 1 < code.size() && code[at + 1] == '=');
        if (value < code.size() && gcode::is_digit(code[value])) return whole_at(code, value);
    }
    return std::nullopt;
}

/// The radius in Klartext's TOOL DEF 3 L+0 R+5, if present and above 0.
std::optional<double> radius_defined(const std::string& code) {
    const size_t tool = code.find("TOOLDEF");
    if (tool == std::string::npos) return std::nullopt;
    size_t at = code.find('R', tool);
    if (at == std::string::npos) return std::nullopt;
    at += 1 + (at + 1 < code.size() && code[at + 1] == '+');
    double radius = 0.0;
    std::from_chars(code.data() + at, code.data() + code.size(), radius);
    return radius > 0.0 ? std::optional(radius) : std::nullopt;
}

bool moves(const std::string& code) {
    return code.find_first_of("XYZ") != std::string::npos
           && code.find_first_of("0123456789") != std::string::npos;
}

/// State of the scan that assigns comments to tools.
struct Scan {
    gcode::LengthUnit unit;
    ProgramTools& found;
    std::deque<std::pair<ToolComment, size_t>> waiting{}; // since the last motion
    std::optional<int> selected{};
    bool calls_tools = false;
    size_t moves_since_call = 0;

    std::vector<std::string> names{}; // of Siemens' T="NAME", in order of their numbers

    void comment(const std::string& words, size_t line);
    void code(const std::string& code, size_t line);
    void name(std::string_view text, size_t line);
    void note(int number, const ToolComment& comment, size_t line);
    std::optional<FoundTool> tool_of(const ToolComment& comment, size_t line) const;
    std::optional<FoundTool> best_waiting() const;
};

/// Whether a comment that is not in the form of a tool list is a tool's name rather than a
/// sentence.
bool is_name(const ToolText& text) {
    constexpr size_t longest = 14, longest_without_unit = 5;
    if (text.words > longest || text.prose) return false;
    if (text.shape == ToolShape::chamfer && text.angle_deg && !text.diameter) return true;
    return text.sized || (text.pointed && text.words <= longest_without_unit);
}

/// A tapered mill of which the diameter at the tip is given; its flutes have the usual length.
void widen_upwards(core::ToolDescription& tool) {
    constexpr double usual_flutes = 3.0, usual_angle = 5.0; // diameters; degrees
    tool.tip_diameter = tool.diameter;
    const double flank = core::radians_of(tool.angle_deg.value_or(usual_angle));
    tool.diameter += 2.0 * usual_flutes * tool.tip_diameter * core::tan(flank);
}

std::optional<FoundTool> Scan::tool_of(const ToolComment& comment, size_t line) const {
    if (!comment.whole && !is_name(comment.text)) return std::nullopt;
    FoundTool named;
    named.source = fmt::format("the comment in line {}", line);
    ToolText text = comment.text;
    named.has_shape = text.shape.has_value();
    if (!text.shape && (text.stated || comment.whole)) text.shape = ToolShape::flat;
    // A V-bit is defined by its angle; its width at the top matters little.
    constexpr double usual_bit = 6.0;
    if (text.shape == ToolShape::chamfer && text.angle_deg && !text.diameter) {
        text.diameter = usual_bit;
        named.has_diameter = false;
    }
    const auto tool = tool_of_text(text);
    if (!tool) return std::nullopt;
    named.tool = *tool;
    if (comment.flank_angle && tool->shape == ToolShape::chamfer)
        named.tool.angle_deg = text.angle_deg;
    if (comment.flank_angle && tool->shape == ToolShape::taper) widen_upwards(named.tool);
    return named;
}

/// The best of the comments before a call: the last complete one, else two that complete each
/// other.
std::optional<FoundTool> Scan::best_waiting() const {
    std::optional<FoundTool> weak;
    for (auto it = waiting.rbegin(); it != waiting.rend(); ++it) {
        if (it->first.number) continue;
        const auto tool = tool_of(it->first, it->second);
        if (tool && tool->has_shape) return tool;
        if (tool && !weak) weak = tool;
    }
    for (size_t i = waiting.size(); i-- > 1;) {
        ToolComment both = waiting[i].first;
        const ToolText& before = waiting[i - 1].first.text;
        constexpr size_t most_words = 4; // per comment
        if (both.number || waiting[i - 1].first.number) continue;
        if (std::max(both.text.words, before.words) > most_words) continue;
        if (!both.text.shape) both.text.shape = before.shape;
        if (!both.text.diameter) both.text.diameter = before.diameter;
        if (const auto tool = tool_of(both, waiting[i].second)) return tool;
    }
    return weak;
}

void Scan::note(int number, const ToolComment& comment, size_t line) {
    auto tool = tool_of(comment, line);
    if (!tool || number < 0) return;
    tool->tool.number = ToolNumber{number};
    const auto known = found.tools.find(ToolNumber{number});
    const bool better = known == found.tools.end() || (tool->has_shape && !known->second.has_shape);
    if (better) found.tools.insert_or_assign(ToolNumber{number}, *tool);
}

void Scan::comment(const std::string& words, size_t line) {
    ToolComment read = read_tool_comment(words, unit);
    const bool says_something = read.number || read.text.shape || read.text.diameter;
    if (!says_something) return;
    if (read.number && read.text.diameter) {
        note(*read.number, read, line);
        return;
    }
    // A number alone belongs to the sizes in adjacent comments, in any order.
    if (read.number && !read.text.shape) {
        for (const auto& [other, source] : waiting)
            if (other.text.diameter && !other.number) note(*read.number, other, source);
        return;
    }
    if (selected && moves_since_call == 0 && waiting.empty()
        && !found.tools.contains(ToolNumber{*selected}) && tool_of(read, line)) {
        note(*selected, read, line);
        return;
    }
    constexpr size_t most = 12;
    waiting.emplace_back(std::move(read), line);
    if (waiting.size() > most) waiting.pop_front();
}

void Scan::code(const std::string& code, size_t line) {
    if (const auto number = tool_called(code)) {
        selected = *number;
        calls_tools = calls_tools || *number != 0;
        moves_since_call = 0;
        auto tool = best_waiting();
        if (tool && !found.tools.contains(ToolNumber{*number})) {
            tool->tool.number = ToolNumber{*number};
            found.tools.emplace(tool->tool.number, *tool);
        }
        if (const auto radius = radius_defined(code)) {
            FoundTool& defined = found.tools[ToolNumber{*number}];
            if (defined.source.empty()) {
                defined.source = fmt::format("TOOL DEF in line {}", line);
                defined.tool.number = ToolNumber{*number};
                defined.tool.diameter = 2.0 * gcode::to_mm(*radius, unit);
            }
        }
        if (tool) waiting.clear();
        return;
    }
    if (!moves(code)) return;
    if (!calls_tools && !found.in_spindle) found.in_spindle = best_waiting();
    ++moves_since_call;
    if (calls_tools) waiting.clear();
}

/// T="DRILL 8.5": the name describes the tool. Names are numbered in order of appearance, as in the
/// interpreter.
void Scan::name(std::string_view text, size_t line) {
    const size_t at = text.find("T=\""), end = text.find('"', at + 3);
    if (at == std::string_view::npos || end == std::string_view::npos) return;
    if (text.substr(0, at).find(';') != std::string_view::npos) return;
    const std::string called(text.substr(at + 3, end - at - 3));
    if (called.empty() || std::all_of(called.begin(), called.end(), gcode::is_digit)) return;
    if (std::find(names.begin(), names.end(), called) != names.end()) return;
    names.push_back(called);
    std::string words = called;
    std::replace(words.begin(), words.end(), '_', ' ');
    ToolComment said;
    said.text = read_tool_text(words, unit);
    said.whole = said.text.shape && said.text.diameter;
    auto tool = tool_of(said, line);
    if (!tool) return;
    tool->source = fmt::format("its name in line {}", line);
    tool->tool.number = ToolNumber{static_cast<int>(names.size())};
    found.tools.try_emplace(tool->tool.number, *tool);
}

/// G20, G70, G700 and the like in a block of code, or the unit of a Klartext program.
std::optional<gcode::LengthUnit> unit_in(const std::string& code) {
    using gcode::LengthUnit;
    if (code.find("BEGINPGM") != std::string::npos)
        return code.ends_with("INCH") ? LengthUnit::inch : LengthUnit::mm;
    for (size_t at = code.find('G'); at != std::string::npos; at = code.find('G', at + 1)) {
        if (at > 0 && !gcode::is_digit(code[at - 1]) && code[at - 1] != '.') continue;
        const auto value = whole_at(code, at + 1);
        if (value == 20 || value == 70 || value == 700) return LengthUnit::inch;
        if (value == 21 || value == 71 || value == 710) return LengthUnit::mm;
    }
    return std::nullopt;
}

} // namespace

gcode::LengthUnit unit_at_start(const gcode::Environment& environment) {
    return environment.units_at_start.value_or(environment.machine_unit);
}

gcode::LengthUnit unit_of_program(const gcode::Program& program, gcode::LengthUnit otherwise) {
    for (size_t line = 1; line <= program.line_count(); ++line)
        if (const auto unit = unit_in(parts_of_line(program.line(line)).code)) return *unit;
    return otherwise;
}

namespace {

/// Reads all lines of a program.
void scan_lines(Scan& scan, const gcode::Program& program) {
    for (size_t line = 1; line <= program.line_count(); ++line) {
        const LineParts parts = parts_of_line(program.line(line));
        scan.name(program.line(line), line);
        for (const std::string& comment : parts.comments) scan.comment(comment, line);
        if (!parts.code.empty()) scan.code(parts.code, line);
    }
}

/// The tool in the spindle of a program without tool calls.
std::optional<FoundTool> tool_without_call(const Scan& scan) {
    if (scan.calls_tools) return std::nullopt;
    if (scan.found.in_spindle) return scan.found.in_spindle;
    if (auto waiting = scan.best_waiting()) return waiting;
    if (scan.found.tools.size() == 1) return scan.found.tools.begin()->second;
    return std::nullopt;
}

} // namespace

ProgramTools tools_of_program(const gcode::Program& program, gcode::LengthUnit unit) {
    ProgramTools found;
    Scan scan{unit, found};
    scan_lines(scan, program);
    found.in_spindle = tool_without_call(scan);
    return found;
}

namespace {

using gcode::LengthUnit;

constexpr auto style = std::regex::ECMAScript | std::regex::optimize;
const char* const number_text = R"(([0-9]*\.?[0-9]+|[0-9]+\.?))";

/// The same with a decimal comma, in forms without lists of numbers; not "12,3 FLUTE".
const char* const number_with_comma = R"(([0-9]*[.,]?[0-9]+(?! *FL)|[0-9]+[.,]?))";

std::regex pattern(std::string text) {
    for (const auto& [name, meaning] :
         {std::pair{"<N>", number_text}, std::pair{"<C>", number_with_comma}})
        for (size_t at = text.find(name); at != std::string::npos; at = text.find(name, at))
            text.replace(at, 3, meaning);
    return std::regex(text, style);
}

double number_of(std::string text) {
    std::replace(text.begin(), text.end(), ',', '.');
    double value = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

int whole_of(const std::string& text) {
    int value = -1;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

/// A form of comment: its pattern, in capitals, and a function that reads a match.
struct Form {
    std::regex pattern;
    void (*read)(const std::smatch& match, LengthUnit unit, ToolComment& comment);
};

void read_fusion(const std::smatch& m, LengthUnit unit, ToolComment& comment) {
    const std::string stated = m[3], rest = m[6];
    const LengthUnit own = stated == "MM"   ? LengthUnit::mm
                           : stated.empty() ? unit
                                            : LengthUnit::inch;
    comment.number = whole_of(m[1]);
    comment.text = read_tool_text(rest, unit);
    comment.text.diameter = gcode::to_mm(number_of(m[2]), own);
    comment.text.stated = comment.whole = true;
    if (m[4].matched) comment.text.corner_radius = gcode::to_mm(number_of(m[4]), own);
    if (m[5].matched) comment.text.angle_deg = number_of(m[5]);
    comment.flank_angle = rest.find("COUNTER") == std::string::npos;
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
        {pattern(R"(^ *T *([0-9]+) +D=<C>(?![0-9/.])(?! *[0-9]+/))"
                 R"((?: *(MM|IN(?:CH)?\b(?! *HOLDER)|"))?)"
                 R"((?: +CR=<C> *(?:MM|IN(?:CH)?\b|")?)?(?: +TAPER=<C> *DEG)?(.*)$)"),
         read_fusion},
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

/// A key and a value alone on a line, as in the headers of some systems.
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
    constexpr size_t longest = 200; // longer than any tool name; limits the cost of the patterns
    ToolComment comment;
    if (words.size() > longest) return comment;
    std::string capitals = core::upper_case(words);
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

namespace {

/// In most languages square brackets hold a value; as a comment they contain words.
bool is_prose(std::string_view text) {
    size_t letters = 0, words = 0;
    bool inside = false;
    for (const char c : text) {
        if (c == '#' || c == '*' || c == '+') return false;
        const bool letter = std::isalpha(static_cast<unsigned char>(c)) != 0;
        letters += letter;
        words += letter && !inside;
        inside = letter;
    }
    return words >= 2 && letters >= 6;
}

} // namespace

LineParts parts_of_line(std::string_view line) {
    LineParts parts;
    for (size_t at = 0; at < line.size(); ++at) {
        const char c = line[at];
        const char closing = c == '(' ? ')' : c == '[' ? ']' : '\0';
        if (c == ';') {
            parts.comments.emplace_back(line.substr(at + 1));
            break;
        }
        if (closing != '\0') {
            size_t end = line.find(closing, at);
            if (end == std::string_view::npos) end = line.size();
            const std::string_view inside = line.substr(at + 1, end - at - 1);
            if (c == '(' || is_prose(inside)) {
                parts.comments.emplace_back(inside);
                at = end;
                continue;
            }
        }
        if (c != ' ' && c != '\t' && c != '\r') parts.code += core::upper(c);
    }
    return parts;
}

} // namespace app

#include "app/setup/inference/stated_stock.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <vector>

#include <fmt/format.h>

#include "app/setup/tools/program_tools.h"
#include "gcode/language/dialect.h"
#include "gcode/language/lexer.h"
#include "gcode/language/modal_state.h"
#include "gcode/text/source.h"

namespace app {
namespace {

using core::Vec3;

std::optional<double> number_in(std::string text) {
    if (text.starts_with('+')) text.erase(0, 1);
    for (char& c : text)
        if (c == ',') c = '.'; // as controls with German settings write it
    double value = 0.0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc() || end == text.data()) return std::nullopt;
    return value;
}

/// The corner behind BLK FORM 0.1 or 0.2, in a code without blanks: X-5Y+0Z-20. Where a coordinate
/// has an I in front, it counts from the other corner.
std::optional<Vec3> corner_in(const std::string& words, const Vec3& other) {
    Vec3 corner(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const size_t at = words.find("XYZ"[axis], words.starts_with("Z") && axis == 2 ? 1 : 0);
        if (at == std::string::npos) return std::nullopt;
        const auto value = number_in(words.substr(at + 1));
        if (!value) return std::nullopt;
        const bool counts_on = at > 0 && words[at - 1] == 'I';
        corner[axis] = *value + (counts_on ? other[axis] : 0.0);
    }
    return corner;
}

std::vector<std::string> arguments_of(const std::string& code, size_t opening) {
    std::vector<std::string> arguments(1);
    for (size_t at = opening + 1; at < code.size() && code[at] != ')'; ++at) {
        if (code[at] == ',')
            arguments.emplace_back();
        else if (code[at] != '"')
            arguments.back() += code[at];
    }
    return arguments;
}

/// WORKPIECE(,,,"BOX",112,top,bottom,machining depth,x,y,x,y)
std::optional<std::array<Vec3, 2>> workpiece_box(const std::vector<std::string>& arguments) {
    constexpr size_t form = 3, first = 5, count = 12;
    if (arguments.size() < count || arguments[form] != "BOX") return std::nullopt;
    std::array<double, count - first> n{};
    for (size_t i = 0; i < n.size(); ++i) {
        const auto value = number_in(arguments[first + i]);
        if (!value && i != 2) return std::nullopt;
        n[i] = value.value_or(0.0);
    }
    return std::array{Vec3(n[3], n[4], n[1]), Vec3(n[5], n[6], n[0])};
}

std::string capitals(std::string_view text) {
    std::string result;
    for (const char c : text)
        if (c != ' ' && c != '\t' && c != '\r') result += c >= 'a' && c <= 'z' ? c - 32 : c;
    return result;
}

/// The header of Vectric's programs, comment by comment.
struct MaterialHeader {
    bool announced = false; // (Material Size)
    std::optional<Vec3> size{};
    bool zero_on_table = false;
    std::string corner; // of the zero: BOTTOMLEFT, CENTER; empty where it is not said
    size_t line = 0;

    void comment(const std::string& words, size_t number) {
        const auto says = [&](const char* text) { return words.find(text) != std::string::npos; };
        if (says("MATERIALSIZE")) announced = true;
        if (says("ZORIGIN") || says("ZZERO")) zero_on_table = says("TABLE") || says("BOTTOM");
        for (const char* name : {"BOTTOMLEFT", "BOTTOMRIGHT", "TOPLEFT", "TOPRIGHT", "CENT"})
            if (says("XYORIGIN") && says(name)) corner = name;
        if (!announced || size) return;
        Vec3 read(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            const size_t at = words.find(std::string(1, "XYZ"[axis]) + "=");
            if (at == std::string::npos) return;
            read[axis] = number_in(words.substr(at + 2)).value_or(0.0);
        }
        size = read;
        line = number;
    }

    /// The low corner in units of the program, seen from its zero.
    std::optional<Vec3> low(const std::optional<core::Aabb>& reach, double scale) const {
        Vec3 result(0.0, 0.0, zero_on_table ? 0.0 : -size->z);
        if (corner == "CENT") {
            result.x = -0.5 * size->x;
            result.y = -0.5 * size->y;
        } else if (!corner.empty()) {
            if (corner.ends_with("RIGHT")) result.x = -size->x;
            if (corner.starts_with("TOP")) result.y = -size->y;
        } else {
            if (!reach) return std::nullopt;
            const auto holds = [&](const Vec3& low) {
                constexpr double beyond = 0.1; // of the size, which outlines are cut outside
                const Vec3 room = (1.0 + beyond) * *size, from = low - beyond * *size;
                return reach->min.x >= scale * from.x && reach->min.y >= scale * from.y
                       && reach->max.x <= scale * (low + room).x
                       && reach->max.y <= scale * (low + room).y;
            };
            const Vec3 middle(-0.5 * size->x, -0.5 * size->y, result.z);
            if (holds(result)) return result;
            if (!holds(middle)) return std::nullopt;
            return middle;
        }
        return result;
    }
};

struct Scan {
    gcode::LengthUnit unit;
    std::optional<Vec3> first{};
    std::optional<StatedStock> found{};
    MaterialHeader header{};

    void take(const Vec3& a, const Vec3& b, std::string source) {
        const core::Aabb box{glm::min(a, b), glm::max(a, b)};
        const Vec3 size = box.size();
        if (size.x <= 0.0 || size.y <= 0.0 || size.z <= 0.0) return;
        const double scale = gcode::to_mm(1.0, unit);
        found = {{box.min * scale, box.max * scale}, std::move(source)};
    }

    void blank_form(const std::string& code, size_t number) {
        const size_t blank = code.find("BLKFORM0.");
        if (blank == std::string::npos || blank + 10 > code.size()) return;
        const auto corner = corner_in(code.substr(blank + 10), first.value_or(Vec3(0.0)));
        if (code[blank + 9] == '1')
            first = corner;
        else if (first && corner)
            take(*first, *corner, fmt::format("BLK FORM in line {}", number));
    }

    void line(std::string_view text, size_t number) {
        const std::string code = capitals(text.substr(0, text.find(';')));
        blank_form(code, number);
        if (const size_t piece = code.find("WORKPIECE("); piece != std::string::npos)
            if (const auto box = workpiece_box(arguments_of(code, piece + 9)))
                take((*box)[0], (*box)[1], fmt::format("WORKPIECE in line {}", number));
        if (code.starts_with('(') || text.starts_with(';'))
            header.comment(capitals(text.substr(1)), number);
    }

    void end(const std::optional<core::Aabb>& reach) {
        if (found || !header.size) return;
        if (const auto low = header.low(reach, gcode::to_mm(1.0, unit)))
            take(*low, *low + *header.size,
                 fmt::format("the material's size in line {}", header.line));
    }
};

} // namespace

std::optional<StatedStock> stated_stock(const gcode::Program& program, gcode::LengthUnit unit,
                                        const std::optional<core::Aabb>& reach) {
    Scan scan{unit};
    for (size_t line = 1; line <= program.line_count(); ++line) scan.line(program.line(line), line);
    scan.end(reach);
    return scan.found;
}

namespace {

bool is_number_part(char c) { return (c >= '0' && c <= '9') || c == '.' || c == ']'; }

/// A code that only turning has a use for: diameters or radii along X, a constant surface speed,
/// and roughing and threading cycles by the words that they have there.
std::optional<std::string> turning_code(const std::string& code) {
    const auto has = [&](const char* letters) {
        return code.find_first_of(letters) != std::string::npos;
    };
    for (size_t at = code.find('G'); at != std::string::npos; at = code.find('G', at + 1)) {
        if (at > 0 && !is_number_part(code[at - 1])) continue;
        double value = 0.0;
        const char* end = code.data() + code.size();
        const auto [behind, failure] = std::from_chars(code.data() + at + 1, end, value);
        if (failure != std::errc()) continue;
        const bool diameters = value == 7.0 || value == 8.0;
        const bool limits_speed = value == 50.0 && has("S");
        const bool roughs = value >= 70.0 && value < 74.0 && has("QUW") && has("PUDR");
        const bool threads = value == 76.0 && has("K") && has("I");
        if (diameters || limits_speed || roughs || threads || value == 96.0)
            return code.substr(at, static_cast<size_t>(behind - code.data()) - at);
    }
    return std::nullopt;
}

/// T0101: tool and offset in one word, as turrets have it.
std::optional<std::string> turret_word(const std::string& code) {
    for (size_t at = code.find('T'); at != std::string::npos; at = code.find('T', at + 1)) {
        const size_t end = std::min(code.size(), code.find_first_not_of("0123456789", at + 1));
        if (at > 0 && !is_number_part(code[at - 1])) continue;
        if (end - at == 5) return code.substr(at, 5);
    }
    return std::nullopt;
}

/// Whether a block says where an axis goes.
bool moves_axis(const std::string& code, char axis) {
    for (size_t at = code.find(axis); at != std::string::npos; at = code.find(axis, at + 1)) {
        const bool in_a_word = at > 0 && std::isalpha(static_cast<unsigned char>(code[at - 1]));
        if (at + 1 >= code.size() || (in_a_word && code[at - 1] != 'I')) continue;
        if (gcode::is_digit(code[at + 1])
            || std::string("+-.=[#").find(code[at + 1]) != std::string::npos)
            return true;
    }
    return false;
}

bool changes_tool(const std::string& code) {
    for (const char* word : {"M6", "M06"}) {
        const size_t at = code.find(word), end = at + std::string(word).size();
        if (at != std::string::npos && (end >= code.size() || !gcode::is_digit(code[end])))
            return true;
    }
    return false;
}

} // namespace

std::optional<std::string> turning_reason(const gcode::Program& program) {
    std::optional<std::string> code_reason, turret_reason, plane_reason;
    bool changes = false, moves_x = false;
    const auto say = [](std::optional<std::string>& reason, size_t line, const std::string& what) {
        if (!reason) reason = fmt::format("it never moves Y, and line {} says {}", line, what);
    };
    for (size_t line = 1; line <= program.line_count(); ++line) {
        const std::string code = parts_of_line(program.line(line)).code;
        if (moves_axis(code, 'Y')) return std::nullopt;
        moves_x = moves_x || moves_axis(code, 'X');
        changes = changes || changes_tool(code);
        if (const auto said = turning_code(code)) say(code_reason, line, *said);
        if (const auto turret = turret_word(code)) say(turret_reason, line, *turret);
        if (code.find("G18") != std::string::npos) say(plane_reason, line, "G18");
    }
    if (!moves_x) return std::nullopt;
    if (code_reason) return code_reason;
    return turret_reason && !changes ? turret_reason : plane_reason;
}

std::optional<size_t> line_that_asks_for_places(const gcode::Program& program) {
    for (size_t line = 1; line <= program.line_count(); ++line) {
        const std::string code = parts_of_line(program.line(line)).code;
        const bool asks = code.find("SYSREAD") != std::string::npos;
        if (asks
            && (code.find("ID270") != std::string::npos || code.find("ID240") != std::string::npos))
            return line;
    }
    return std::nullopt;
}

} // namespace app

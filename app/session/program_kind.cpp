#include "app/session/program_kind.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

#include "app/tools/line_comments.h"

namespace app {
namespace {

bool is_number_part(char c) { return (c >= '0' && c <= '9') || c == '.' || c == ']'; }

bool is_decimal_digit(char c) { return c >= '0' && c <= '9'; }

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
        if (is_decimal_digit(code[at + 1])
            || std::string("+-.=[#").find(code[at + 1]) != std::string::npos)
            return true;
    }
    return false;
}

bool changes_tool(const std::string& code) {
    for (const char* word : {"M6", "M06"}) {
        const size_t at = code.find(word), end = at + std::string(word).size();
        if (at != std::string::npos && (end >= code.size() || !is_decimal_digit(code[end])))
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

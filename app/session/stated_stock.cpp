#include "app/session/stated_stock.h"

#include <array>
#include <charconv>
#include <vector>

#include <fmt/format.h>

#include "app/tools/line_comments.h"
#include "gcode/axes.h"

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

struct Scan {
    gcode::LengthUnit unit;
    std::optional<Vec3> low{};
    std::optional<StatedStock> found{};

    void take(const Vec3& a, const Vec3& b, std::string source) {
        const core::Aabb box{glm::min(a, b), glm::max(a, b)};
        const Vec3 size = box.size();
        if (size.x <= 0.0 || size.y <= 0.0 || size.z <= 0.0) return;
        const double scale = gcode::to_mm(1.0, unit);
        found = {{box.min * scale, box.max * scale}, std::move(source)};
    }

    void line(std::string_view text, size_t number) {
        const std::string code = capitals(text.substr(0, text.find(';')));
        if (const size_t blank = code.find("BLKFORM0."); blank != std::string::npos) {
            const std::string words = code.substr(std::min(code.size(), blank + 10));
            const auto corner = corner_in(words, low.value_or(Vec3(0.0)));
            if (code[std::min(code.size() - 1, blank + 9)] == '1')
                low = corner;
            else if (low && corner)
                take(*low, *corner, fmt::format("BLK FORM in line {}", number));
        }
        if (const size_t piece = code.find("WORKPIECE("); piece != std::string::npos)
            if (const auto box = workpiece_box(arguments_of(code, piece + 9)))
                take((*box)[0], (*box)[1], fmt::format("WORKPIECE in line {}", number));
    }
};

} // namespace

std::optional<StatedStock> stated_stock(const gcode::Program& program, gcode::LengthUnit unit) {
    Scan scan{unit};
    for (size_t line = 1; line <= program.line_count(); ++line) scan.line(program.line(line), line);
    return scan.found;
}

} // namespace app

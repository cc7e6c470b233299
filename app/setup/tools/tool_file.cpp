#include "app/setup/tools/tool_file.h"

#include <optional>

#include <fmt/format.h>

#include "app/base/text.h"
#include "core/base/text.h"
#include "gcode/language/modal_state.h"
#include "gcode/language/tables.h"

namespace app {
namespace {

constexpr double highest_tool = 99999999.0;

/// One line of the table, read word by word.
struct ToolLine {
    gcode::LengthUnit unit;
    std::optional<core::OffsetNumber> number{};
    gcode::LengthOffset offset{};

    /// Reads a word. Returns why it is invalid; empty if it is valid.
    std::string take(char letter, double value);
};

bool is_whole(double value, double highest) {
    return value >= 0.0 && value <= highest && value == static_cast<int>(value);
}

std::string ToolLine::take(char letter, double value) {
    const size_t axis = gcode::axis_letters.find(letter);
    if (letter == 'T') {
        if (!is_whole(value, highest_tool)) return "T must be a whole number";
        if (number) return "has two T words";
        number = core::OffsetNumber{static_cast<int>(value)};
    } else if (letter == 'Z') {
        offset.length = gcode::to_mm(value, unit);
    } else if (axis < gcode::axis_count) {
        offset.shift[axis] = gcode::is_rotary(axis) ? value : gcode::to_mm(value, unit);
    } else if (letter == 'D') {
        offset.diameter = gcode::to_mm(value, unit);
    } else if (letter == 'I') {
        offset.front_deg = value;
    } else if (letter == 'J') {
        offset.back_deg = value;
    } else if (letter == 'Q') {
        if (!is_whole(value, 9.0)) return "Q must be an orientation from 0 to 9";
        offset.orientation = static_cast<int>(value);
    } else if (letter != 'P') { // the pocket is irrelevant here
        return fmt::format("{} is not a letter of a tool table (T P X Y Z A B C U V W D I J Q)",
                           letter);
    }
    return {};
}

} // namespace

core::Result<std::map<core::OffsetNumber, gcode::LengthOffset>>
read_tool_file(const std::string& path, gcode::LengthUnit unit) {
    FEELER_TRY(const std::vector<std::string> lines, lines_of_file(path));
    std::map<core::OffsetNumber, gcode::LengthOffset> offsets;
    for (size_t line = 1; line <= lines.size(); ++line) {
        const std::string& text = lines[line - 1];
        const std::vector<std::string> words = words_of_line(text.substr(0, text.find(';')));
        if (words.empty()) continue;
        ToolLine tool{unit};
        for (const std::string& word : words) {
            const auto value = number_in(std::string_view(word).substr(1));
            const char letter = core::upper(word[0]);
            const std::string wrong =
                value ? tool.take(letter, *value) : "is not a letter and a number";
            if (!wrong.empty())
                return tl::unexpected(line_error(path, line, fmt::format("'{}': {}", word, wrong)));
        }
        if (!tool.number)
            return tl::unexpected(line_error(path, line, "a line of a tool table needs a T word"));
        if (!offsets.emplace(*tool.number, tool.offset).second)
            return tl::unexpected(line_error(
                path, line, fmt::format("T{} is defined twice", core::value_of(*tool.number))));
    }
    return offsets;
}

} // namespace app

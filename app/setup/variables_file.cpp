#include "app/setup/variables_file.h"

#include <fmt/format.h>

#include "app/setup/text_lines.h"
#include "gcode/parameters.h"

namespace app {

core::Result<std::map<int, double>> read_variables(const std::string& path) {
    FEELER_TRY(const std::vector<std::string> lines, lines_of_file(path));
    std::map<int, double> variables;
    for (size_t line = 1; line <= lines.size(); ++line) {
        const std::vector<std::string> words = words_of_line(lines[line - 1]);
        if (words.empty() || words[0][0] == ';' || words[0][0] == '#') continue;
        const auto number = number_in(words[0]);
        const auto value = words.size() > 1 ? number_in(words[1]) : std::nullopt;
        const bool more = words.size() > 2 && words[2][0] != ';' && words[2][0] != '#';
        if (!number || !value || more)
            return tl::unexpected(line_error(
                path, line, "a line of a variables file is a number and its value: 5221 -350.0"));
        if (!(*number >= 1.0 && *number <= gcode::highest_parameter)
            || *number != static_cast<int>(*number))
            return tl::unexpected(
                line_error(path, line, fmt::format("there is no parameter #{}", words[0])));
        if (!variables.emplace(static_cast<int>(*number), *value).second)
            return tl::unexpected(
                line_error(path, line, fmt::format("#{} is there twice", words[0])));
    }
    return variables;
}

} // namespace app

#include "gcode/program_text.h"

namespace gcode {

std::vector<uint32_t> starts_of_lines(std::string_view text) {
    std::vector<uint32_t> starts;
    bool is_start = true;
    for (size_t at = 0; at < text.size(); ++at) {
        if (is_start) starts.push_back(static_cast<uint32_t>(at));
        const char c = text[at];
        is_start = c == '\n' || (c == '\r' && !text.substr(at + 1).starts_with('\n'));
    }
    return starts;
}

bool has_a_block(std::string_view text) {
    char comment = '\0';
    for (const char c : text) {
        if (is_line_end(c))
            comment = '\0';
        else if (comment == '(' && c == ')')
            comment = '\0';
        else if (comment == '\0' && (c == '(' || c == ';' || c == '%'))
            comment = c;
        else if (comment == '\0' && static_cast<unsigned char>(c) > ' ')
            return true;
    }
    return false;
}

} // namespace gcode

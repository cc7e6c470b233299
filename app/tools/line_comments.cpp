#include "app/tools/line_comments.h"

#include <cctype>

namespace app {
namespace {

/// Square brackets hold a value in most languages; a comment in them has words.
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
        if (c != ' ' && c != '\t' && c != '\r')
            parts.code += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
    return parts;
}

} // namespace app

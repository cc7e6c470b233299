#include "gcode/text/program_text.h"

#include <algorithm>
#include <charconv>

namespace gcode {

std::optional<size_t> lone_return(std::string_view text) {
    for (size_t at = 0; (at = text.find('\r', at)) != std::string_view::npos; ++at) {
        const size_t next = text.find_first_not_of('\r', at);
        if (next == std::string_view::npos) return {};
        if (text[next] != '\n') return at;
        at = next;
    }
    return {};
}

std::vector<uint32_t> starts_of_lines(std::string_view text) {
    std::vector<uint32_t> starts;
    const bool has_returns = text.find('\r') != std::string_view::npos;
    for (size_t at = 0; at < text.size();) {
        starts.push_back(static_cast<uint32_t>(at));
        const size_t end = has_returns ? text.find_first_of("\r\n", at) : text.find('\n', at);
        if (end == std::string_view::npos) break;
        at = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
    }
    return starts;
}

std::string_view nul_bytes_error(std::string_view text) {
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
        return "is UTF-16 text, which controls cannot read: save it as plain text (ASCII or UTF-8)";
    return "contains NUL bytes: it is a binary file, not an NC program";
}

std::optional<uint32_t> number_in(std::string_view text) {
    uint32_t number = 0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), number);
    if (end.ec != std::errc{} || end.ptr != text.data() + text.size()) return std::nullopt;
    return number;
}

std::optional<uint32_t> block_number(std::string_view line, bool has_letter) {
    size_t at = line.find_first_not_of(" \t/");
    if (at == std::string_view::npos) return std::nullopt;
    if (has_letter && line[at] != 'N' && line[at] != 'n') return std::nullopt;
    at += has_letter ? 1 : 0;
    const size_t end = line.find_first_not_of("0123456789", at);
    return number_in(line.substr(at, end == std::string_view::npos ? end : end - at));
}

size_t count_stray_controls(std::string_view text) {
    // Nearly all control characters are line ends or tabs; cheap counts rule out any others.
    size_t low = 0, common = 0;
    for (const char c : text) low += static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
    for (const char c : text) common += c == '\n' || c == '\r' || c == '\t';
    if (low == common) return 0;
    return static_cast<size_t>(std::count_if(text.begin(), text.end(), is_stray_control));
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

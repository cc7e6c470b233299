#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace gcode {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

constexpr bool is_line_end(char c) { return c == '\n' || c == '\r'; }

/// Where the lines of a text begin. A line ends at LF, CR, or CR LF.
std::vector<uint32_t> starts_of_lines(std::string_view text);

/// The text between the start of a line and that of the next one, without the line end.
inline std::string_view without_line_end(std::string_view line) {
    while (!line.empty() && is_line_end(line.back())) line.remove_suffix(1);
    return line;
}

/// What a file with NUL bytes is, for a message: another encoding by its first two bytes, or no
/// text.
std::string_view what_has_nuls(std::string_view text);

/// Whether the text has anything besides comments, tape marks and blanks.
bool has_a_block(std::string_view text);

/// The number that a text is, if it is nothing but digits.
std::optional<uint32_t> number_in(std::string_view text);

/// The number of a block: after N, or at the start of the line in languages without N.
std::optional<uint32_t> block_number(std::string_view line, bool has_letter);

/// Whether a character is a control character that no NC program has a use for. Tape readers left
/// XON, XOFF and friends; DOS left its end-of-file mark.
constexpr bool is_stray_control(char c) {
    const bool harmless = (c >= '\t' && c <= '\r') || (c >= 0x11 && c <= 0x14) || c == 0x1A;
    return (static_cast<unsigned char>(c) < 0x20 && !harmless) || c == 0x7F;
}

/// How many of them a text has.
size_t count_stray_controls(std::string_view text);

/// Whether a text has so many of them that it is another format. A few are damaged lines.
constexpr bool looks_binary(size_t stray_controls, size_t size) {
    return stray_controls * 10 > size;
}

} // namespace gcode

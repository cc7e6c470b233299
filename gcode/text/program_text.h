#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace gcode {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

constexpr bool is_line_end(char c) { return c == '\n' || c == '\r'; }

/// Offsets at which the lines of a text begin. A line ends at LF, CR, or CR LF.
std::vector<uint32_t> starts_of_lines(std::string_view text);

/// The line without its line end. `line` is the text up to the start of the next line.
inline std::string_view without_line_end(std::string_view line) {
    while (!line.empty() && is_line_end(line.back())) line.remove_suffix(1);
    return line;
}

/// The offset of a CR after which more of a line follows: neither LF, further CRs up to LF, nor the
/// end of the text. Empty if there is none.
std::optional<size_t> lone_return(std::string_view text);

/// Message for a text with NUL bytes: UTF-16 by its first two bytes, else a binary file.
std::string_view nul_bytes_error(std::string_view text);

/// Whether the text has anything besides comments, tape marks and blanks.
bool has_a_block(std::string_view text);

/// The number, if the text consists of digits only.
std::optional<uint32_t> number_in(std::string_view text);

/// The number of a block: after N, or at the start of the line in languages without N.
std::optional<uint32_t> block_number(std::string_view line, bool has_letter);

/// Whether a character is a control character with no use in NC programs. XON, XOFF and the like
/// are left over from tape readers, 0x1A is the end-of-file mark of DOS.
constexpr bool is_stray_control(char c) {
    const bool harmless = (c >= '\t' && c <= '\r') || (c >= 0x11 && c <= 0x14) || c == 0x1A;
    return (static_cast<unsigned char>(c) < 0x20 && !harmless) || c == 0x7F;
}

/// Number of stray control characters in a text.
size_t count_stray_controls(std::string_view text);

/// Whether a text has so many stray controls that it must be another format. A few are damaged
/// lines.
constexpr bool looks_binary(size_t stray_controls, size_t size) {
    return stray_controls * 10 > size;
}

} // namespace gcode

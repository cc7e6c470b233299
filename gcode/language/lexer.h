#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/base/text.h"
#include "gcode/language/block.h"

namespace gcode {

/// A number in a program.
struct Number {
    double value = 0.0;
    bool has_point = false;
};

constexpr bool is_blank(char c) {
    // Only harmless control characters, left over from tapes, reach this point.
    constexpr uint64_t blanks = uint64_t{1} << ' ' | uint64_t{1} << '\t' | uint64_t{1} << '\v'
                                | uint64_t{1} << '\f' | uint64_t{1} << 0x1A;
    return static_cast<unsigned char>(c) <= ' ' && (blanks >> c & 1);
}
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
using core::lower;
using core::upper;
constexpr bool is_letter(char c) { return upper(c) >= 'A' && upper(c) <= 'Z'; }
constexpr bool is_name_part(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

/// A read position in a line. A plain value: copy it to look ahead.
///
/// Source: NISTIR 6556 (RS274/NGC v3), 3.3; blanks are allowed anywhere, even inside numbers and
///         names.
struct Lexer {
    std::string_view line;
    uint32_t line_number = 1;
    size_t at = 0;
    bool blanks_end_numbers = false; // Klartext and Siemens
    bool comma_is_point = false;     // Klartext: a comma may be the decimal point
    bool has_exponents = false;      // Siemens: 1.5EX-3
    bool comments_nest = true;       // otherwise a comment ends at the first ) or with its line

    /// The next character that is not blank, without consuming it; NUL at the end.
    char peek() {
        while (at < line.size() && is_blank(line[at])) ++at;
        return at < line.size() ? line[at] : '\0';
    }

    /// Consumes the next character if it is `wanted`.
    bool accept(char wanted) {
        if (peek() != wanted) return false;
        ++at;
        return true;
    }

    /// Consumes these characters if they come next, ignoring case.
    bool accept_word(std::string_view wanted);

    /// The next letters in upper case without blanks, without consuming them.
    std::string letters();

    /// The text from a position up to the current one.
    core::SourceSpan span_from(size_t begin) const { return span(begin, at); }
    core::SourceSpan span(size_t begin, size_t end) const {
        return {line_number, static_cast<uint32_t>(begin + 1), static_cast<uint32_t>(end - begin)};
    }
    std::string written_from(size_t begin) const {
        return std::string(line.substr(begin, at - begin));
    }

    /// Whether a number begins here: with a sign, a digit or a point.
    bool is_at_number();

    /// Reads a number.
    ///
    /// Errors: syntax when there is none, or it has too many digits.
    core::Result<Number> number();
    tl::unexpected<core::Error> bad_exponent(size_t begin) const;

    /// Reads the comment in brackets that begins here and ends at the matching bracket; where
    /// comments do not nest, at the first closing bracket or with the line.
    ///
    /// Errors: syntax when comments nest and it is not closed on the line.
    core::Result<Comment> bracket_comment();

    /// Reads the rest of the line after the current character as a comment.
    Comment line_comment();

    /// The error for an unexpected character, with a guess of the intention.
    tl::unexpected<core::Error> unexpected_character();
};

inline constexpr std::array powers_of_ten = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                             1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

/// Reads a number of at most 15 digits without blanks inside, as nearly all are. Returns false, and
/// changes nothing, for any other kind.
///
/// The digits form a whole number below 2^53, and the power of ten is below 10^16: both are exact,
/// so their quotient is rounded once, as in the general reader.
inline bool read_short_number(std::string_view line, size_t& at, Number& number) {
    const char* next = line.data() + at;
    const char* const end = line.data() + line.size();
    const bool negative = next < end && *next == '-';
    next += next < end && (*next == '-' || *next == '+');
    uint64_t digits = 0;
    const char* const first = next;
    for (; next < end && is_digit(*next); ++next)
        digits = digits * 10 + static_cast<uint64_t>(*next - '0');
    auto count = next - first;
    size_t decimals = 0;
    const bool point = next < end && *next == '.';
    if (point) {
        const char* const fraction = ++next;
        for (; next < end && is_digit(*next); ++next)
            digits = digits * 10 + static_cast<uint64_t>(*next - '0');
        decimals = static_cast<size_t>(next - fraction);
        count += next - fraction;
    }
    if (count == 0 || count > 15) return false;
    const char* after = next;
    while (after < end && is_blank(*after)) ++after;
    // A number may contain blanks: leave these to the general reader.
    if (after < end && (*after == '.' || (after > next && is_digit(*after)))) return false;
    const double size = static_cast<double>(digits) / powers_of_ten[decimals];
    number = {negative ? -size : size, point};
    at = static_cast<size_t>(next - line.data());
    return true;
}

} // namespace gcode

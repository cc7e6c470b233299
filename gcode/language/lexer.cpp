#include "gcode/language/lexer.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// The characters of a number without blanks, and the position after it.
struct Digits {
    std::array<char, 64> text;
    size_t count = 0;
    size_t digits = 0;
    bool has_point = false;
    bool too_long = false;
    size_t end = 0;
};

Digits collect_digits(std::string_view line, size_t begin) {
    Digits found;
    found.end = begin;
    for (size_t at = begin; at < line.size(); ++at) {
        const char c = line[at];
        if (is_blank(c)) continue;
        const bool sign = (c == '-' || c == '+') && found.count == 0 && found.end == begin;
        const bool point = c == '.' && !found.has_point;
        if (!sign && !point && !is_digit(c)) break;
        found.end = at + 1;
        found.has_point |= point;
        found.digits += is_digit(c);
        if (c == '+') continue;
        if (found.count == found.text.size()) {
            found.too_long = true;
            continue;
        }
        found.text[found.count++] = c;
    }
    return found;
}

/// Klartext and Siemens allow blanks only after the sign.
Digits collect_digits_without_blanks(std::string_view line, size_t begin, bool comma) {
    Digits found;
    size_t at = begin;
    if (at < line.size() && (line[at] == '-' || line[at] == '+')) {
        if (line[at] == '-') found.text[found.count++] = '-';
        for (++at; at < line.size() && is_blank(line[at]);) ++at;
    }
    for (; at < line.size(); ++at) {
        const bool point = (line[at] == '.' || (comma && line[at] == ',')) && !found.has_point;
        if (!point && !is_digit(line[at])) break;
        found.has_point |= point;
        found.digits += !point;
        if (found.count < found.text.size())
            found.text[found.count++] = point ? '.' : line[at];
        else
            found.too_long = true;
    }
    found.end = at;
    return found;
}

/// Siemens: `EX` and a whole number after a number are an exponent of ten.
bool take_exponent(std::string_view line, size_t& at, Number& number) {
    if (at + 2 >= line.size() || upper(line[at]) != 'E' || upper(line[at + 1]) != 'X') return true;
    size_t next = at + 2;
    const bool negative = line[next] == '-';
    if (negative || line[next] == '+') ++next;
    int exponent = 0;
    const size_t digits = next;
    for (; next < line.size() && is_digit(line[next]) && exponent < 1000; ++next)
        exponent = exponent * 10 + (line[next] - '0');
    if (next == digits || exponent > 300) return false;
    number.value *= core::pow(10.0, negative ? -exponent : exponent);
    at = next;
    return true;
}

} // namespace

bool Lexer::accept_word(std::string_view wanted) {
    Lexer ahead = *this;
    for (const char c : wanted) {
        if (upper(ahead.peek()) != c) return false;
        ++ahead.at;
    }
    *this = ahead;
    return true;
}

std::string Lexer::letters() {
    std::string found;
    for (Lexer ahead = *this; is_letter(ahead.peek()); ++ahead.at)
        found.push_back(upper(ahead.peek()));
    return found;
}

bool Lexer::is_at_number() {
    const char c = peek();
    return is_digit(c) || c == '.' || c == '-' || c == '+';
}

tl::unexpected<core::Error> Lexer::bad_exponent(size_t begin) const {
    return core::fail(
        ErrorCode::syntax,
        fmt::format("the exponent of '{}' must be a whole number up to 300", written_from(begin)),
        span_from(begin));
}

core::Result<Number> Lexer::number() {
    peek();
    const size_t begin = at;
    if (Number number; !comma_is_point && read_short_number(line, at, number)) {
        if (!has_exponents || take_exponent(line, at, number)) return number;
        return bad_exponent(begin);
    }
    const Digits found = blanks_end_numbers
                             ? collect_digits_without_blanks(line, begin, comma_is_point)
                             : collect_digits(line, begin);
    if (found.digits == 0)
        return core::fail(ErrorCode::syntax, "a number is missing here", span(begin, begin + 1));
    at = found.end;
    if (found.too_long)
        return core::fail(ErrorCode::syntax,
                          fmt::format("the number '{}...' has too many digits",
                                      written_from(begin).substr(0, 20)),
                          span_from(begin));
    Number number{.has_point = found.has_point};
    std::from_chars(found.text.data(), found.text.data() + found.count, number.value,
                    std::chars_format::fixed);
    if (has_exponents && !take_exponent(line, at, number)) return bad_exponent(begin);
    return number;
}

core::Result<Comment> Lexer::bracket_comment() {
    const size_t begin = at;
    if (!comments_nest) {
        const size_t end = std::min(line.find(')', begin), line.size());
        at = std::min(end + 1, line.size());
        return Comment{line.substr(begin + 1, end - begin - 1), span_from(begin)};
    }
    int depth = 0;
    for (; at < line.size(); ++at) {
        depth += (line[at] == '(') - (line[at] == ')');
        if (depth > 0) continue;
        ++at;
        return Comment{line.substr(begin + 1, at - begin - 2), span_from(begin)};
    }
    return core::fail(ErrorCode::syntax,
                      fmt::format("the comment '{}' is not closed: it needs a ')' on the same line",
                                  written_from(begin)),
                      span_from(begin));
}

Comment Lexer::line_comment() {
    const size_t begin = at;
    at = line.size();
    return {line.substr(begin + 1), span_from(begin)};
}

tl::unexpected<core::Error> Lexer::unexpected_character() {
    const char c = peek();
    const core::SourceSpan where = span(at, at + 1);
    if (c == '\0')
        return core::fail(ErrorCode::syntax, "the line ends here, but more is expected", where);
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7E)
        return core::fail(ErrorCode::syntax,
                          fmt::format("the byte 0x{:02X} is not allowed outside comments",
                                      static_cast<unsigned char>(c)),
                          where);
    if (c == '[')
        return core::fail(ErrorCode::syntax,
                          "'[' is not allowed here: a value in brackets must follow a letter, and "
                          "comments in brackets (WinCNC) must be written in ( and )",
                          where);
    return core::fail(ErrorCode::syntax, fmt::format("'{}' is not allowed here", c), where);
}

} // namespace gcode

#include "gcode/lexer.h"

#include <array>
#include <charconv>

#include <fmt/format.h>

namespace gcode {
namespace {

using core::ErrorCode;

constexpr std::string_view word_letters = "ABCDFGHIJKLMNOPQRSTUVWXYZ";

/// Control characters that reach the lexer are the harmless ones of old tapes.
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == 0x1A; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

void skip_blanks(Lexer& lexer) {
    while (lexer.at < lexer.line.size() && is_blank(lexer.line[lexer.at])) ++lexer.at;
}

char peek(const Lexer& lexer) { return lexer.at < lexer.line.size() ? lexer.line[lexer.at] : '\0'; }

core::SourceSpan span_of(const Lexer& lexer, size_t begin, size_t end) {
    return {lexer.line_number, static_cast<uint32_t>(begin + 1),
            static_cast<uint32_t>(end - begin)};
}

std::string written(const Lexer& lexer, size_t begin, size_t end) {
    return std::string(lexer.line.substr(begin, end - begin));
}

tl::unexpected<core::Error> unexpected_character(const Lexer& lexer, size_t at) {
    const char c = lexer.line[at];
    const core::SourceSpan span = span_of(lexer, at, at + 1);
    if (c == '#' || c == '[' || c == ']' || c == '=' || c == '<' || c == '>')
        return core::fail(ErrorCode::unsupported,
                          fmt::format("'{}': parameters and expressions are not supported by this "
                                      "version",
                                      c),
                          span);
    if (c == ',' || c == '@' || c == '^')
        return core::fail(ErrorCode::unsupported,
                          fmt::format("'{}': corner and polar words are not supported by this "
                                      "version",
                                      c),
                          span);
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7E)
        return core::fail(ErrorCode::syntax,
                          fmt::format("the byte 0x{:02X} has no meaning outside of a comment",
                                      static_cast<unsigned char>(c)),
                          span);
    return core::fail(ErrorCode::syntax, fmt::format("'{}' has no meaning here", c), span);
}

/// A comment ends at the bracket that matches, so that one may hold another.
core::Result<Token> lex_bracket_comment(Lexer& lexer) {
    const size_t begin = lexer.at;
    int depth = 0;
    for (size_t at = begin; at < lexer.line.size(); ++at) {
        depth += (lexer.line[at] == '(') - (lexer.line[at] == ')');
        if (depth > 0) continue;
        lexer.at = at + 1;
        return Token{.kind = TokenKind::comment,
                     .span = span_of(lexer, begin, at + 1),
                     .text = lexer.line.substr(begin + 1, at - begin - 1)};
    }
    return core::fail(ErrorCode::syntax,
                      fmt::format("the comment '{}' is not closed: it needs a ')' on its line",
                                  written(lexer, begin, lexer.line.size())),
                      span_of(lexer, begin, lexer.line.size()));
}

Token lex_line_comment(Lexer& lexer) {
    const size_t begin = lexer.at;
    lexer.at = lexer.line.size();
    return {.kind = TokenKind::comment,
            .span = span_of(lexer, begin, lexer.line.size()),
            .text = lexer.line.substr(begin + 1)};
}

/// `/`, or `/1` to `/9`; `/10` is no switch.
Token lex_slash(Lexer& lexer) {
    const size_t begin = lexer.at++;
    double number = 1.0;
    const char digit = peek(lexer);
    if (digit >= '1' && digit <= '9') {
        number = digit - '0';
        ++lexer.at;
    }
    return {.kind = TokenKind::slash, .span = span_of(lexer, begin, lexer.at), .value = number};
}

/// Two or more letters in a row are a keyword of some control, which deserves a better message.
tl::unexpected<core::Error> missing_number(const Lexer& lexer, size_t begin) {
    size_t end = begin;
    while (end < lexer.line.size() && is_letter(lexer.line[end])) ++end;
    if (end - begin > 1)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("'{}': keywords are not supported by this version, and a "
                                      "letter needs a number",
                                      written(lexer, begin, end)),
                          span_of(lexer, begin, end));
    const size_t next = lexer.line.find_first_not_of("+- \t", lexer.at);
    if (next != std::string_view::npos && std::string_view("#[<").find(lexer.line[next]) < 3)
        return unexpected_character(lexer, next);
    return core::fail(ErrorCode::syntax,
                      fmt::format("'{}' has no number behind it", written(lexer, begin, begin + 1)),
                      span_of(lexer, begin, begin + 1));
}

/// The characters of a number without its blanks, and where it ends.
struct Digits {
    std::array<char, 64> text;
    size_t count = 0;
    size_t digits = 0;
    bool has_point = false;
    bool too_long = false;
    size_t end = 0;
};

Digits collect_digits(const Lexer& lexer, size_t begin) {
    Digits found;
    found.end = begin;
    for (size_t at = begin; at < lexer.line.size(); ++at) {
        const char c = lexer.line[at];
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

core::Result<Token> lex_word(Lexer& lexer) {
    const size_t begin = lexer.at++;
    const char letter = upper(lexer.line[begin]);
    skip_blanks(lexer);
    const Digits found = collect_digits(lexer, lexer.at);
    if (found.digits == 0) return missing_number(lexer, begin);
    if (word_letters.find(letter) == std::string_view::npos)
        return core::fail(ErrorCode::syntax,
                          fmt::format("'{}' is not a word of this language; an exponent such as "
                                      "1E3 is written out",
                                      written(lexer, begin, found.end)),
                          span_of(lexer, begin, found.end));
    if (found.too_long)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("the number of '{}' has too many digits", written(lexer, begin, found.end)),
            span_of(lexer, begin, found.end));
    double value = 0.0;
    std::from_chars(found.text.data(), found.text.data() + found.count, value,
                    std::chars_format::fixed);
    lexer.at = found.end;
    return Token{.kind = TokenKind::word,
                 .span = span_of(lexer, begin, found.end),
                 .letter = letter,
                 .value = value,
                 .has_point = found.has_point};
}

} // namespace

core::Result<Token> Lexer::next() {
    skip_blanks(*this);
    if (at == line.size()) return Token{.span = span_of(*this, at, at)};
    const char c = line[at];
    if (c == '(') return lex_bracket_comment(*this);
    if (c == ';') return lex_line_comment(*this);
    if (c == '/') return lex_slash(*this);
    if (c == '%') {
        ++at;
        return Token{.kind = TokenKind::percent, .span = span_of(*this, at - 1, at)};
    }
    if (is_letter(c)) return lex_word(*this);
    if (is_digit(c) || c == '.' || c == '-' || c == '+') {
        const size_t end = std::max(collect_digits(*this, at).end, at + 1);
        return core::fail(ErrorCode::syntax,
                          fmt::format("'{}' has no letter before it", written(*this, at, end)),
                          span_of(*this, at, end));
    }
    return unexpected_character(*this, at);
}

} // namespace gcode

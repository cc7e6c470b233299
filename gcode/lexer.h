#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/result.h"

namespace gcode {

enum class TokenKind : uint8_t { end, word, comment, slash, percent };

/// The next thing on a line.
struct Token {
    TokenKind kind = TokenKind::end;
    core::SourceSpan span{};
    char letter = '\0';      // of a word, upper case
    double value = 0.0;      // of a word; of a slash, its switch (1 when it has no digit)
    bool has_point = false;  // of a word
    std::string_view text{}; // of a comment
};

/// Takes a line apart. A plain cursor: copy it to look ahead.
struct Lexer {
    std::string_view line;
    uint32_t line_number = 1;
    size_t at = 0;

    /// The next token; kind `end` at the end of the line.
    ///
    /// Errors: syntax when a letter has no number, a number no letter, a comment no end, or a
    ///         character no meaning; unsupported at expressions, parameters and keywords.
    /// Source: NISTIR 6556 (RS274/NGC v3), 3.3; blanks are allowed anywhere, also inside numbers.
    core::Result<Token> next();
};

} // namespace gcode

#include "gcode/parser.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

#include "gcode/lexer.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr std::array flow_keywords = {"sub",      "endsub", "call",   "if",        "elseif",
                                      "else",     "endif",  "while",  "endwhile",  "do",
                                      "continue", "break",  "repeat", "endrepeat", "return"};

/// The letters that follow, blanks left out, lower case.
std::string keyword_at(const Lexer& lexer) {
    std::string letters;
    for (const char c : lexer.line.substr(lexer.at)) {
        if (std::isblank(static_cast<unsigned char>(c))) continue;
        if (!std::isalpha(static_cast<unsigned char>(c))) break;
        letters.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
    }
    return letters;
}

core::Result<void> refuse_flow_control(const Lexer& lexer, const Token& token) {
    const std::string keyword = keyword_at(lexer);
    if (std::find(flow_keywords.begin(), flow_keywords.end(), keyword) == flow_keywords.end())
        return {};
    return core::fail(ErrorCode::unsupported,
                      fmt::format("'O{:.12g} {}': O words are not supported by this version",
                                  token.value, keyword),
                      token.span);
}

core::Result<void> add_word(Block& block, const Lexer& lexer, const Token& token) {
    if (token.letter == 'O')
        if (auto allowed = refuse_flow_control(lexer, token); !allowed) return allowed;
    const bool repeatable = token.letter == 'G' || token.letter == 'M';
    const auto same_letter = [&](const Word& word) { return word.letter == token.letter; };
    if (!repeatable && std::any_of(block.words.begin(), block.words.end(), same_letter))
        return core::fail(ErrorCode::syntax,
                          fmt::format("'{}': a block takes one {} word, this is the second",
                                      lexer.line.substr(token.span.column - 1, token.span.length),
                                      token.letter),
                          token.span);
    block.words.push_back({token.letter, token.value, token.span, token.has_point});
    return {};
}

/// `/` stands first, or right after the N word.
core::Result<void> set_block_delete(Block& block, const Token& token) {
    const bool first = block.words.empty() && !block.block_delete;
    const bool after_number = block.words.size() == 1 && block.words[0].letter == 'N';
    if (!first && !(after_number && !block.block_delete))
        return core::fail(ErrorCode::syntax, "'/' belongs at the start of the block", token.span);
    block.block_delete = static_cast<int>(token.value);
    return {};
}

core::Result<void> add(Block& block, const Lexer& lexer, const Token& token) {
    if (token.kind == TokenKind::comment)
        block.comments.push_back({token.text, token.span});
    else if (token.kind == TokenKind::slash)
        return set_block_delete(block, token);
    else if (token.kind == TokenKind::word)
        return add_word(block, lexer, token);
    else if (!block.words.empty())
        return core::fail(ErrorCode::syntax, "'%' belongs at the start of a line", token.span);
    else
        block.tape_mark = true;
    return {};
}

} // namespace

core::Result<Block> parse_line(std::string_view text, uint32_t line) {
    Block block{.line = line, .text = text};
    Lexer lexer{.line = text, .line_number = line};
    while (true) {
        // What follows a tape mark on its line is the name some controls put there.
        if (block.tape_mark) return block;
        FEELER_TRY(const Token token, lexer.next());
        if (token.kind == TokenKind::end) return block;
        if (auto added = add(block, lexer, token); !added)
            return tl::unexpected(std::move(added).error());
    }
}

} // namespace gcode

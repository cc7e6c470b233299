#include "gcode/iso/plain_words.h"

#include "gcode/language/lexer.h"

namespace gcode {
namespace {

constexpr uint32_t bit_of(char letter) { return 1u << (letter - 'A'); }

/// The letters that may occur several times in a block.
uint32_t repeatable_letters(const Dialect& dialect) {
    const uint32_t codes = bit_of('G') | bit_of('M');
    const uint32_t offsets = bit_of('I') | bit_of('J') | bit_of('K');
    return dialect.offset_words_may_repeat ? codes | offsets : codes;
}

/// O words are flow statements, words after a macro call are arguments, and some are refused.
bool needs_full_parser(char letter, double value, const Dialect& dialect) {
    if (letter == 'O' || dialect.refused_letters.find(letter) != std::string_view::npos)
        return true;
    return letter == 'G' && dialect.has_fanuc_flow && value >= 65.0 && value < 67.0;
}

} // namespace

bool read_plain_words(std::string_view text, uint32_t line, const Dialect& dialect, Block& block) {
    if (dialect.longest_line != 0 && text.size() > dialect.longest_line) return false;
    const uint32_t repeatable = repeatable_letters(dialect);
    uint32_t seen = 0;
    size_t at = 0;
    while (true) {
        while (at < text.size() && is_blank(text[at])) ++at;
        if (at == text.size()) return true;
        const size_t begin = at;
        const char letter = upper(text[at++]);
        if (letter < 'A' || letter > 'Z') return false;
        while (at < text.size() && is_blank(text[at])) ++at;
        Number number;
        if (!read_short_number(text, at, number)) return false;
        const uint32_t bit = bit_of(letter);
        if ((seen & bit & ~repeatable) || needs_full_parser(letter, number.value, dialect))
            return false;
        seen |= bit;
        block.words.push_back(
            {.letter = letter,
             .value = number.value,
             .span = {line, static_cast<uint32_t>(begin + 1), static_cast<uint32_t>(at - begin)},
             .has_point = number.has_point});
    }
}

} // namespace gcode

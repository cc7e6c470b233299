#pragma once

#include <array>
#include <span>
#include <vector>

#include "gcode/language/block.h"
#include "gcode/language/codes.h"

namespace gcode {

struct Environment;

/// A G or M word and its code.
struct CodeWord {
    const Code* code = nullptr;
    const Word* word = nullptr;
};

constexpr uint32_t letter_bit(char letter) { return 1u << (letter - 'A'); }

constexpr uint32_t letter_bits(std::string_view letters) {
    uint32_t bits = 0;
    for (const char letter : letters) bits |= letter_bit(letter);
    return bits;
}

constexpr uint32_t axis_letter_bits = letter_bits(axis_letters);
constexpr uint32_t corner_bit = 1u << 26; // ,R or ,C

/// A block with its words looked up. Refers to the words of the block.
struct Statement {
    static constexpr size_t most_codes = 32;

    std::array<const Word*, 26> words{};         // by letter, without G and M
    const Word* polar_radius = nullptr;          // @
    const Word* polar_angle = nullptr;           // ^
    const Word* corner = nullptr;                // ,R or ,C
    const Word* angle = nullptr;                 // ,A
    std::array<CodeWord, most_codes> code_words; // in the order written
    size_t code_count = 0;
    uint64_t groups = 0;                        // one bit for each modal group present
    uint32_t letters = 0;                       // one bit for each of `words` present
    std::vector<const Word*> unknown_m_codes{}; // of a machine builder
    std::vector<const Word*> overruled{};       // G codes before another of their group
    std::vector<const Word*> arguments{};       // of a macro call: the words after G65 or G66

    std::span<const CodeWord> codes() const { return {code_words.data(), code_count}; }
    const Word* word(char letter) const { return words[static_cast<size_t>(letter - 'A')]; }
    const CodeWord* of(ModalGroup group) const {
        if (!(groups & (uint64_t{1} << static_cast<unsigned>(group)))) return nullptr;
        return find(group);
    }
    bool has_axis_word() const {
        return (letters & axis_letter_bits) != 0 || polar_radius || polar_angle;
    }

    /// The code that takes the axis words instead of the motion: G10, G28, G30, G52, G92, G43.1, or
    /// a G4 without P.
    const CodeWord* axis_word_owner() const;

private:
    const CodeWord* find(ModalGroup group) const;
};

/// Looks up the meaning of a block's words in a dialect. Under G66.1 all words except G codes are
/// arguments.
///
/// Effect: overwrites `statement`.
/// Errors: unsupported for a G code that the dialect or this version does not have, and for an M
///         code that moves the machine, changes its state or jumps; syntax for two codes of one
///         modal group.
core::Result<void> look_up(const Block& block, const Dialect& dialect,
                           const Environment& environment, Statement& statement,
                           bool words_are_arguments = false);

/// A word as written in a program, such as X10.5.
std::string written(const Word& word);

/// The value of a word that is a count or a number of something.
///
/// Errors: invalid_value when it is not a whole number from `lowest` to `highest`.
core::Result<int> whole_number(const Word& word, int lowest = 0, int highest = 99999999);

} // namespace gcode

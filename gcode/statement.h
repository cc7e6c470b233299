#pragma once

#include <array>
#include <vector>

#include "gcode/block.h"
#include "gcode/codes.h"

namespace gcode {

/// A G or M word with the code it names.
struct CodeWord {
    const Code* code;
    const Word* word;
};

/// A block with its words looked up. Refers to the block's words.
struct Statement {
    std::array<const Word*, 26> words{};      // by letter, without G and M
    std::vector<CodeWord> codes;              // in the order written
    std::vector<const Word*> unknown_m_codes; // a machine builder's

    const Word* word(char letter) const { return words[static_cast<size_t>(letter - 'A')]; }
    const CodeWord* of(ModalGroup group) const;
    bool has_axis_word() const { return word('X') || word('Y') || word('Z') || has_rotary_word(); }
    bool has_rotary_word() const { return word('A') || word('B') || word('C'); }

    /// The code that takes the axis words away from the motion: G10, G28, G30, G52, G92, G43.1, and
    /// a G4 that has no P.
    const CodeWord* taker_of_axis_words() const;
};

/// What a block's words mean in a dialect.
///
/// Errors: unsupported for a G code the dialect or this version does not have, and for an M code
///         that moves the machine, changes its state or jumps; syntax for two codes of one modal
///         group.
core::Result<Statement> statement_from_block(const Block& block, const Dialect& dialect);

/// The word as a person would write it, such as X10.5.
std::string written(const Word& word);

/// The value of a word that counts or names something.
///
/// Errors: invalid_value when it is not a whole number from `lowest` to `highest`.
core::Result<int> whole_number(const Word& word, int lowest = 0, int highest = 99999999);

} // namespace gcode

#pragma once

#include <string>

#include "gcode/klartext/klartext_line.h"
#include "gcode/language/dialect.h"
#include "gcode/language/lexer.h"

namespace gcode {

/// A block of Klartext while it is parsed.
struct KlartextReader {
    Lexer lexer;
    const Dialect& dialect;
    Block& block;
    KlartextLine& command; // of the block
    size_t begin = 0;      // of the statement

    /// The next significant character, not consumed; comments before it are stored. NUL at the end.
    char next();

    /// The run of letters at this position, in upper case, not consumed.
    std::string letters();

    /// Consumes exactly this word, or this prefix, if it comes next.
    bool accept(std::string_view keyword);
    bool accept_prefix(std::string_view prefix);

    /// Reads a number or parameter and adds it as a word that starts at `from`.
    core::Result<void> word(char letter, size_t from, Addressing addressing = Addressing::absolute);
    void add_word(char letter, double value, size_t from);

    /// Reads a number or parameter as an expression of the pool.
    core::Result<Expression> operand();

    core::SourceSpan span_from(size_t from) const { return lexer.span_from(from); }
    tl::unexpected<core::Error> refuse(std::string message, size_t from,
                                       core::ErrorCode code = core::ErrorCode::syntax);

    /// The error for text that is not allowed at this position of the statement.
    tl::unexpected<core::Error> stray();
};

/// Reads one word of a motion: an axis, F, R0, DR+, M ...
core::Result<void> read_contour_word(KlartextReader& reader);

/// Reads an M word.
core::Result<void> read_m_word(KlartextReader& reader);

/// Reads the name of a label: a number, a name in quotation marks, or a Q parameter.
core::Result<void> read_label_name(KlartextReader& reader);

/// Reads a whole number without a sign.
core::Result<int> read_whole(KlartextReader& reader, std::string_view after);

/// Reads `Q5 =`, and adds the assignment of a value to it.
core::Result<int> read_target(KlartextReader& reader);
core::Result<void> set_result(KlartextReader& reader, int target, Expression value);

// Read the rest of a statement after its first keyword.
core::Result<void> read_tool(KlartextReader& reader);       // TOOL CALL, TOOL DEF
core::Result<void> read_cycle(KlartextReader& reader);      // CYCL DEF, CYCL CALL
core::Result<void> read_function(KlartextReader& reader);   // FN 0: ...
core::Result<void> read_label(KlartextReader& reader);      // LBL
core::Result<void> read_call(KlartextReader& reader);       // CALL LBL, CALL PGM
core::Result<void> read_assignment(KlartextReader& reader); // Q1 = ...

} // namespace gcode

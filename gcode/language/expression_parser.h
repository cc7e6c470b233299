#pragma once

#include <span>
#include <string_view>

#include "gcode/language/expression.h"
#include "gcode/language/lexer.h"

namespace gcode {

/// Reads a value: a number, `#5`, `#<name>`, `[...]` or a function of brackets, each with an
/// optional sign. For a plain number, sets `number` and returns an empty expression.
///
/// Effect: adds the instructions to the pool.
/// Errors: syntax with the column of the mistake.
core::Result<Expression> parse_value(Lexer& lexer, ExpressionSyntax syntax, ExpressionPool& pool,
                                     Number& number);

/// Reads a value, or sums and products of values without brackets, as Fanuc and Siemens allow after
/// `=`.
///
/// Errors: syntax with the column of the mistake.
core::Result<Expression> parse_sum(Lexer& lexer, ExpressionSyntax syntax, ExpressionPool& pool,
                                   Number& number);

/// Reads `[...]`.
///
/// Errors: syntax with the column of the mistake.
core::Result<Expression> parse_bracketed(Lexer& lexer, ExpressionSyntax syntax,
                                         ExpressionPool& pool);

/// The numbers under which Q0 and QR0 are stored; Q1 to Q1999 keep their numbers.
constexpr int q_zero = 2000, first_stored_q = 2001;

/// Reads `Q5` or `QR5` and returns the number under which it is stored.
///
/// Errors: syntax without a number; unsupported for QL and QS; invalid_value when there is no such
///         parameter.
core::Result<int> parse_q_parameter(Lexer& lexer);

/// Reads the name of a parameter between `<` and `>`: lower case, without blanks.
///
/// Errors: syntax when the closing `>` or the name is missing.
core::Result<std::string> parse_name(Lexer& lexer);

/// An operator between two values.
struct Operator {
    std::string_view spelling;
    Operation operation;
    int rank; // higher binds tighter
};

/// A function of one value.
struct Function {
    std::string_view name;
    Operation operation;
};

/// The operators of a family of controls; of two with the same beginning, the longer one comes
/// first.
std::span<const Operator> operators_of(ExpressionSyntax syntax);

/// The functions of Klartext, or those of the other controls.
std::span<const Function> functions_of(ExpressionSyntax syntax);

} // namespace gcode

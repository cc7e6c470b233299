#pragma once

#include <span>
#include <string_view>

#include "gcode/expression.h"
#include "gcode/expression_parser.h"

namespace gcode {

/// An operator between two values.
struct Operator {
    std::string_view spelling;
    Operation operation;
    int rank; // what binds tighter has the higher one
};

/// A function of one value.
struct Function {
    std::string_view name;
    Operation operation;
};

/// The operators of a family of controls; of two that begin alike, the longer one comes first.
std::span<const Operator> operators_of(ExpressionSyntax syntax);

/// The functions of Klartext, or of all others.
std::span<const Function> functions_of(ExpressionSyntax syntax);

} // namespace gcode

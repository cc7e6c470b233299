#include "gcode/expression_syntax.h"

namespace gcode {
namespace {

using enum Operation;

// Of two that begin alike, the longer one comes first.
constexpr Operator rs274_operators[] = {{"**", power, 6},
                                        {"*", multiply, 5},
                                        {"/", divide, 5},
                                        {"MOD", modulo, 5},
                                        {"+", add, 4},
                                        {"-", subtract, 4},
                                        {"EQ", equal, 3},
                                        {"NE", not_equal, 3},
                                        {"GE", greater_or_equal, 3},
                                        {"GT", greater, 3},
                                        {"LE", less_or_equal, 3},
                                        {"LT", less, 3},
                                        {"AND", truth_and, 2},
                                        {"OR", truth_or, 2},
                                        {"XOR", truth_xor, 2}};

constexpr Operator fanuc_operators[] = {{"*", multiply, 5},
                                        {"/", divide, 5},
                                        {"MOD", modulo, 5},
                                        {"AND", truth_and, 5},
                                        {"+", add, 4},
                                        {"-", subtract, 4},
                                        {"OR", truth_or, 4},
                                        {"XOR", truth_xor, 4},
                                        {"EQ", equal, 3},
                                        {"NE", not_equal, 3},
                                        {"GE", greater_or_equal, 3},
                                        {"GT", greater, 3},
                                        {"LE", less_or_equal, 3},
                                        {"LT", less, 3}};

constexpr Operator siemens_operators[] = {
    {"*", multiply, 7},       {"/", divide, 7},       {"DIV", divide_whole, 7},
    {"MOD", modulo, 7},       {"+", add, 6},          {"-", subtract, 6},
    {"B_AND", bits_and, 5},   {"B_XOR", bits_xor, 5}, {"B_OR", bits_or, 5},
    {"AND", truth_and, 4},    {"XOR", truth_xor, 3},  {"OR", truth_or, 2},
    {"==", equal, 1},         {"<>", not_equal, 1},   {">=", greater_or_equal, 1},
    {"<=", less_or_equal, 1}, {">", greater, 1},      {"<", less, 1}};

constexpr Operator klartext_operators[] = {{"*", multiply, 5}, {"/", divide, 5},
                                           {"%", modulo, 5},   {"^", power, 6},
                                           {"+", add, 4},      {"-", subtract, 4}};

constexpr Function unary_functions[] = {{"ABS", absolute},
                                        {"ACOS", arc_cosine},
                                        {"ASIN", arc_sine},
                                        {"COS", cosine},
                                        {"EXP", exponential},
                                        {"FIX", fix},
                                        {"FUP", fup},
                                        {"LN", logarithm},
                                        {"ROUND", Operation::round},
                                        {"SIN", sine},
                                        {"SQRT", square_root},
                                        {"TAN", tangent},
                                        {"SQR", square_root},
                                        {"RND", Operation::round},
                                        {"BIN", from_decimal_code},
                                        {"BCD", to_decimal_code},
                                        {"TRUNC", fix},
                                        {"NOT", truth_not}};

// Of two that begin alike, the longer one comes first. The angle of ATAN is that of y over 1.
constexpr Function klartext_functions[] = {
    {"SQRT", square_root}, {"SQ", square},       {"SIN", sine},
    {"SGN", sign},         {"COS", cosine},      {"TAN", tangent},
    {"ASIN", arc_sine},    {"ACOS", arc_cosine}, {"ATAN", Operation::arc_tangent},
    {"ABS", absolute},     {"INT", truncate},    {"FRAC", fraction},
    {"NEG", negate},       {"LN", logarithm},    {"LOG", decimal_logarithm},
    {"EXP", exponential}};

} // namespace

std::span<const Operator> operators_of(ExpressionSyntax syntax) {
    switch (syntax) {
    case ExpressionSyntax::rs274:
        return rs274_operators;
    case ExpressionSyntax::fanuc:
        return fanuc_operators;
    case ExpressionSyntax::siemens:
        return siemens_operators;
    default:
        return klartext_operators;
    }
}

std::span<const Function> functions_of(ExpressionSyntax syntax) {
    if (syntax == ExpressionSyntax::klartext) return klartext_functions;
    return unary_functions;
}

} // namespace gcode

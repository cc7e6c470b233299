#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace gcode {

/// The expression syntax of a family of controls: operators, functions and brackets.
enum class ExpressionSyntax : uint8_t { rs274, fanuc, siemens, klartext };

/// A value of an expression. Empty is Fanuc's vacant variable, which counts as 0 in arithmetic.
using Value = std::optional<double>;

/// Effect of one step of an expression on the value stack.
enum class Operation : uint8_t {
    number,   // pushes it
    numbered, // replaces a number by the value of the parameter with that number
    named,    // pushes a named parameter
    exists,   // 1 if the named parameter exists
    // operations on one value
    exists_numbered, // 1 if there is a parameter with that number
    negate,
    absolute,
    arc_cosine,
    arc_sine,
    cosine,
    exponential,
    fix,
    fup,
    logarithm,
    round,
    sine,
    square_root,
    tangent,
    from_decimal_code, // BIN
    to_decimal_code,   // BCD
    truth_not,
    decimal_logarithm,
    sign,     // -1, 0 or 1
    fraction, // the digits after the point
    truncate, // the digits before the point
    square,
    full_turn,          // an angle in degrees, from 0 to 360
    away_from_zero,     // rounds away from zero
    arc_tangent_of_one, // from -90 to 90
    // operations on two values
    arc_tangent,
    hypotenuse, // square root of the sum of squares
    power,
    multiply,
    divide,
    modulo,
    divide_whole,
    add,
    subtract,
    equal,
    not_equal,
    greater,
    greater_or_equal,
    less,
    less_or_equal,
    truth_and,
    truth_or,
    truth_xor,
    bits_and,
    bits_or,
    bits_xor,
    least,
    greatest,
};

/// One step of an expression in postfix order.
struct Instruction {
    Operation operation = Operation::number;
    uint32_t column = 0; // for messages
    double number = 0.0;
    uint32_t name = 0; // index into ExpressionPool::names
};

/// A range of the pool's instructions; empty when the word has a plain number.
struct Expression {
    uint32_t first = 0, count = 0;

    explicit operator bool() const { return count > 0; }
};

/// The instructions and names of all expressions in a line.
struct ExpressionPool {
    std::vector<Instruction> instructions;
    std::vector<std::string> names; // lower case, without blanks

    void clear() {
        instructions.clear();
        names.clear();
    }
};

/// Gives expressions the values of parameters.
class ParameterReader {
public:
    virtual ~ParameterReader() = default;

    /// Errors: invalid_value when the parameter does not exist.
    virtual core::Result<Value> numbered(double number, core::SourceSpan where) const = 0;
    virtual core::Result<Value> named(std::string_view name, core::SourceSpan where) const = 0;
    virtual bool exists(std::string_view name) const = 0;

    /// The identity of the value that was read last, see Trace.
    virtual std::string identity() const { return {}; }
};

/// Differences between controls in arithmetic.
struct Arithmetic {
    double equality = 0.0;            // EQ is true up to this difference
    bool bitwise_logic = false;       // AND, OR and XOR are bitwise; otherwise logical
    bool fix_is_to_zero = false;      // FIX[-1.2] is -1 and FUP[-1.2] is -2, else -2 and -1
    bool angles_have_no_sign = false; // ASIN and ATAN[y]/[x] are from 0 to 360 degrees
    bool rounds_lengths_to_steps =
        false;                 // ROUND in an X word rounds to the least increment; otherwise to 1
    double steps_in_one = 1.0; // ROUND rounds to 1 divided by this
};

/// How far the comparisons of a condition are from changing their results: the differences of their
/// two sides, in order.
struct Margins {
    std::array<double, 4> values{};
    size_t count = 0; // may be more than there is room for

    bool has_all() const { return count <= values.size(); }
    void add(double margin) {
        if (count < values.size()) values[count] = margin;
        ++count;
    }
};

/// A comparison of an unknown value with a known one.
struct ValueComparison {
    Operation operation = Operation::equal;
    std::string identity; // of the unknown value, on the left
    Value with;
};

/// The identity of a value that is not known. Values of the same identity are equal.
inline constexpr const char* no_identity = "?";

/// What an expression stands for of which some operands are not known.
struct Trace {
    std::string identity; // empty: the value is known; no_identity: another one at each evaluation
    bool is_negated = false; // it is the opposite of the truth value of that identity
    std::optional<ValueComparison> comparison; // if it is one of an unknown and a known value
};

/// Evaluates an expression; `margins`, if given, receives those of its comparisons, and `trace`
/// what the result stands for.
/// Units:  angles in degrees, lengths in the units of the program.
/// Errors: invalid_value with the column: a division by zero, the root of a negative number, a
///         missing parameter, a result that is not finite.
core::Result<Value> evaluate(const ExpressionPool& pool, Expression expression, uint32_t line,
                             const ParameterReader& parameters, const Arithmetic& arithmetic,
                             Margins* margins = nullptr, Trace* trace = nullptr);

/// The numeric value of a condition: 1 or 0.
constexpr double truth(bool holds) { return holds ? 1.0 : 0.0; }

/// The values that a variable can still have after some comparisons with known values, if only the
/// machine knows the variable.
class PossibleValues {
public:
    /// Any number; where unset variables are vacant, it may also be vacant.
    explicit PossibleValues(bool may_be_vacant) : may_be_vacant_(may_be_vacant) {}

    /// Those for which a comparison has this outcome. `equality`: as in Arithmetic.
    PossibleValues where(const ValueComparison& comparison, double equality, bool outcome) const;

    bool is_empty() const { return ranges_.empty() && !may_be_vacant_; }

    bool operator==(const PossibleValues&) const = default;

private:
    struct Range {
        double low = -std::numeric_limits<double>::infinity();
        double high = std::numeric_limits<double>::infinity();
        bool has_low = false, has_high = false; // whether the ends belong to it

        bool operator==(const Range&) const = default;
    };

    static Range common(const Range& a, const Range& b);
    PossibleValues within(const std::vector<Range>& allowed, bool vacant) const;

    std::vector<Range> ranges_{Range{}}; // in ascending order, apart from each other
    bool may_be_vacant_;
};

} // namespace gcode

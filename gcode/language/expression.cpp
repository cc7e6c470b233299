#include "gcode/language/expression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/units.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr double largest_whole = 9007199254740992.0; // 2^53

/// Remainder that is never negative, whatever the sign of the divisor (RS274/NGC 3.3.2.3).
double modulo(double a, double b) {
    const double rest = std::fmod(a, b);
    return rest < 0.0 ? rest + std::abs(b) : rest;
}

/// Reads the digits of a value in base `from` as digits in base `to`: 0x37 from 16 to 10 is 37.
double recode(double value, int from, int to) {
    auto rest = static_cast<int64_t>(value);
    double result = 0.0, weight = 1.0;
    for (; rest > 0; rest /= from, weight *= to)
        result += weight * static_cast<double>(rest % from);
    return result;
}

/// Sines and cosines of multiples of 90 degrees are exact, as in the tables of controls.
double sine_of_degrees(double angle) {
    const double turned = std::remainder(angle, 360.0);
    if (turned == 0.0 || std::abs(turned) == 180.0) return 0.0;
    if (std::abs(turned) == 90.0) return turned > 0.0 ? 1.0 : -1.0;
    return core::sin(angle / core::degrees_per_radian);
}

double cosine_of_degrees(double angle) {
    const double turned = std::abs(std::remainder(angle, 360.0));
    if (turned == 90.0) return 0.0;
    if (turned == 0.0 || turned == 180.0) return turned == 0.0 ? 1.0 : -1.0;
    return core::cos(angle / core::degrees_per_radian);
}

/// Why an operation cannot be computed; empty if it can.
std::string_view objection_to(Operation operation, double a, double b) {
    switch (operation) {
    case Operation::square_root:
        return a < 0.0 ? "the square root of a negative number" : "";
    case Operation::logarithm:
    case Operation::decimal_logarithm:
        return a <= 0.0 ? "the logarithm of a number that is not positive" : "";
    case Operation::arc_cosine:
    case Operation::arc_sine:
        return std::abs(a) > 1.0 ? "the arc sine or cosine of a number outside -1 to 1" : "";
    case Operation::from_decimal_code:
    case Operation::to_decimal_code:
        return a < 0.0 || a > largest_whole ? "BIN or BCD of a number that is negative or too large"
                                            : "";
    case Operation::divide:
        return b == 0.0 ? "a division by zero: the value after '/' is 0" : "";
    case Operation::modulo:
    case Operation::divide_whole:
        return b == 0.0 ? "a division by zero" : "";
    case Operation::power:
        return a < 0.0 && b != std::floor(b)
                   ? "a negative number raised to a power that is not whole"
                   : "";
    case Operation::bits_and:
    case Operation::bits_or:
    case Operation::bits_xor:
        return std::abs(a) > largest_whole || std::abs(b) > largest_whole
                   ? "a bit operation on a number that is too large"
                   : "";
    case Operation::exists_numbered:
        return a != std::floor(a) ? "the number of a parameter that is not whole" : "";
    default:
        return "";
    }
}

// RS274/NGC: #1 to #5601 always exist.
constexpr double parameters_end = 5602.0;

double of_one(Operation operation, double a) {
    switch (operation) {
    case Operation::exists_numbered:
        return truth(a >= 1.0 && a < parameters_end);
    case Operation::negate:
        return -a;
    case Operation::absolute:
        return std::abs(a);
    case Operation::arc_cosine:
        return core::acos(a) * core::degrees_per_radian;
    case Operation::arc_sine:
        return core::asin(a) * core::degrees_per_radian;
    case Operation::cosine:
        return cosine_of_degrees(a);
    case Operation::exponential:
        return core::exp(a);
    case Operation::fix:
        return std::floor(a);
    case Operation::fup:
        return std::ceil(a);
    case Operation::logarithm:
        return core::log(a);
    case Operation::round:
        return core::round(a);
    case Operation::sine:
        return sine_of_degrees(a);
    case Operation::square_root:
        return std::sqrt(a);
    case Operation::tangent:
        return sine_of_degrees(a) / cosine_of_degrees(a);
    case Operation::from_decimal_code:
        return recode(a, 16, 10);
    case Operation::to_decimal_code:
        return recode(a, 10, 16);
    case Operation::decimal_logarithm:
        return core::log10(a);
    case Operation::sign:
        return a > 0.0 ? 1.0 : a < 0.0 ? -1.0 : 0.0;
    case Operation::fraction:
        return a - std::trunc(a);
    case Operation::truncate:
        return std::trunc(a);
    case Operation::square:
        return a * a;
    case Operation::full_turn:
        return modulo(a, 360.0);
    case Operation::away_from_zero:
        return std::copysign(std::ceil(std::abs(a)), a);
    case Operation::arc_tangent_of_one:
        return core::atan(a) * core::degrees_per_radian;
    default:
        return truth(a == 0.0); // truth_not
    }
}

double of_bits(Operation operation, double a, double b) {
    const auto left = static_cast<int64_t>(a), right = static_cast<int64_t>(b);
    if (operation == Operation::bits_and) return static_cast<double>(left & right);
    if (operation == Operation::bits_or) return static_cast<double>(left | right);
    return static_cast<double>(left ^ right);
}

double of_two(Operation operation, double a, double b, double equality) {
    switch (operation) {
    case Operation::arc_tangent:
        return core::atan2(a, b) * core::degrees_per_radian;
    case Operation::hypotenuse:
        return core::hypot(a, b);
    case Operation::power:
        return core::pow(a, b);
    case Operation::multiply:
        return a * b;
    case Operation::divide:
        return a / b;
    case Operation::modulo:
        return modulo(a, b);
    case Operation::divide_whole:
        return std::trunc(a / b);
    case Operation::add:
        return a + b;
    case Operation::subtract:
        return a - b;
    case Operation::equal:
        return truth(std::abs(a - b) <= equality);
    case Operation::not_equal:
        return truth(!(std::abs(a - b) <= equality));
    case Operation::greater:
        return truth(a > b);
    case Operation::greater_or_equal:
        return truth(a >= b);
    case Operation::less:
        return truth(a < b);
    case Operation::less_or_equal:
        return truth(a <= b);
    case Operation::truth_and:
        return truth(a != 0.0 && b != 0.0);
    case Operation::truth_or:
        return truth(a != 0.0 || b != 0.0);
    case Operation::truth_xor:
        return truth((a != 0.0) != (b != 0.0));
    case Operation::least:
        return std::min(a, b);
    case Operation::greatest:
        return std::max(a, b);
    default:
        return of_bits(operation, a, b);
    }
}

Operation with_bits(Operation operation) {
    switch (operation) {
    case Operation::truth_and:
        return Operation::bits_and;
    case Operation::truth_or:
        return Operation::bits_or;
    case Operation::truth_xor:
        return Operation::bits_xor;
    default:
        return operation;
    }
}

Operation with_amounts(Operation operation) {
    if (operation == Operation::fix) return Operation::truncate;
    return operation == Operation::fup ? Operation::away_from_zero : operation;
}

/// The operation as this control defines it.
Operation done_for(Operation operation, const Arithmetic& arithmetic) {
    if (arithmetic.bitwise_logic) operation = with_bits(operation);
    return arithmetic.fix_is_to_zero ? with_amounts(operation) : operation;
}

bool is_angle_of_turn(Operation operation) {
    return operation == Operation::arc_tangent || operation == Operation::arc_sine;
}

constexpr bool is_operand(Operation operation) {
    return operation == Operation::number || operation == Operation::numbered
           || operation == Operation::named || operation == Operation::exists;
}

constexpr bool takes_two_values(Operation operation) {
    switch (operation) {
    case Operation::arc_tangent:
    case Operation::hypotenuse:
    case Operation::power:
    case Operation::multiply:
    case Operation::divide:
    case Operation::modulo:
    case Operation::divide_whole:
    case Operation::add:
    case Operation::subtract:
    case Operation::equal:
    case Operation::not_equal:
    case Operation::greater:
    case Operation::greater_or_equal:
    case Operation::less:
    case Operation::less_or_equal:
    case Operation::truth_and:
    case Operation::truth_or:
    case Operation::truth_xor:
    case Operation::bits_and:
    case Operation::bits_or:
    case Operation::bits_xor:
    case Operation::least:
    case Operation::greatest:
        return true;
    default:
        return false;
    }
}

constexpr bool is_comparison(Operation operation) {
    switch (operation) {
    case Operation::equal:
    case Operation::not_equal:
    case Operation::greater:
    case Operation::greater_or_equal:
    case Operation::less:
    case Operation::less_or_equal:
        return true;
    default:
        return false;
    }
}

Operation mirrored(Operation comparison) {
    switch (comparison) {
    case Operation::greater:
        return Operation::less;
    case Operation::greater_or_equal:
        return Operation::less_or_equal;
    case Operation::less:
        return Operation::greater;
    case Operation::less_or_equal:
        return Operation::greater_or_equal;
    default:
        return comparison;
    }
}

Operation opposite(Operation comparison) {
    switch (comparison) {
    case Operation::greater:
        return Operation::less_or_equal;
    case Operation::greater_or_equal:
        return Operation::less;
    case Operation::less:
        return Operation::greater_or_equal;
    case Operation::less_or_equal:
        return Operation::greater;
    case Operation::equal:
        return Operation::not_equal;
    default:
        return Operation::equal;
    }
}

/// An operand of a traced operation.
struct TracedValue {
    Trace trace;
    Value value; // if it is known

    bool is_known() const { return trace.identity.empty(); }
    std::string text() const {
        if (is_known()) return value ? fmt::format("{}", *value) : "vacant";
        return (trace.is_negated ? "!" : "") + trace.identity;
    }
};

Trace with_identity(std::string identity, bool is_negated = false) {
    constexpr size_t longest = 400;
    if (identity.size() > longest) identity = no_identity;
    return {std::move(identity), is_negated, std::nullopt};
}

/// Comparisons are traced as "equal" and "less" only, so that opposite ones have the same identity.
Trace traced_comparison(Operation operation, const TracedValue& left, const TracedValue& right) {
    if (operation == Operation::greater || operation == Operation::less_or_equal)
        return traced_comparison(mirrored(operation), right, left);
    const bool is_equality = operation == Operation::equal || operation == Operation::not_equal;
    const bool is_negated =
        operation == Operation::not_equal || operation == Operation::greater_or_equal;
    std::string first = left.text(), second = right.text();
    if (is_equality && second < first) std::swap(first, second);
    Trace trace = with_identity(fmt::format("({} {} {})", first, is_equality ? "=" : "<", second),
                                is_negated);
    if (right.is_known()) trace.comparison = {operation, left.text(), right.value};
    if (left.is_known()) trace.comparison = {mirrored(operation), right.text(), left.value};
    return trace;
}

/// What an operation makes of its operands; `right` is empty for operations on one value.
Trace traced(Operation operation, const TracedValue& left, const TracedValue* right) {
    if (left.is_known() && (!right || right->is_known())) return {};
    if (left.trace.identity == no_identity || (right && right->trace.identity == no_identity))
        return with_identity(no_identity);
    if (is_comparison(operation)) return traced_comparison(operation, left, *right);
    if (operation == Operation::truth_not && left.trace.comparison) {
        Trace trace = left.trace;
        trace.is_negated = !trace.is_negated;
        trace.comparison->operation = opposite(trace.comparison->operation);
        return trace;
    }
    const int number = static_cast<int>(operation);
    return with_identity(right ? fmt::format("({} {} {})", number, left.text(), right->text())
                               : fmt::format("({} {})", number, left.text()));
}

constexpr size_t deepest = 64;

/// The value stack for evaluating an expression.
class Stack {
public:
    Stack(const ExpressionPool& pool, uint32_t line, const ParameterReader& parameters,
          const Arithmetic& arithmetic, Margins* margins, bool traces)
        : pool_(pool),
          line_(line),
          parameters_(parameters),
          arithmetic_(arithmetic),
          margins_(margins),
          traces_(traces ? deepest : 0) {}

    core::Result<void> apply(const Instruction& step) {
        const core::SourceSpan where{.line = line_, .column = step.column, .length = 1};
        if (is_operand(step.operation)) return load(step, where);
        const Operation operation = done_for(step.operation, arithmetic_);
        const bool pair = takes_two_values(operation);
        const Value right = pair ? pop() : Value{};
        const Value left = pop();
        if (margins_ && is_comparison(operation))
            margins_->add(std::abs(left.value_or(0.0) - right.value_or(0.0)));
        if (!traces_.empty()) trace_operation(operation, pair, left, right);
        if (is_comparison_with_vacant(operation, left, right)) return {};
        const double a = left.value_or(0.0), b = right.value_or(0.0);
        if (const std::string_view why = objection_to(operation, a, b); !why.empty())
            return core::fail(ErrorCode::invalid_value, fmt::format("this is {}", why), where);
        double result = pair ? of_two(operation, a, b, arithmetic_.equality) : of_one(operation, a);
        if (!std::isfinite(result))
            return core::fail(ErrorCode::invalid_value, "the result is too large", where);
        if (operation == Operation::round && arithmetic_.steps_in_one != 1.0)
            result = core::round(a * arithmetic_.steps_in_one) / arithmetic_.steps_in_one;
        if (arithmetic_.angles_have_no_sign && is_angle_of_turn(operation) && result < 0.0)
            result += 360.0;
        return push(result, where);
    }

    Value top() const { return values_[depth_ - 1]; }
    const Trace& top_trace() const { return traces_[depth_ - 1]; }

private:
    /// The operands were popped; the result takes the place of the first.
    void trace_operation(Operation operation, bool pair, Value left, Value right) {
        Trace& result = traces_[depth_];
        const TracedValue first{std::move(result), left};
        if (!pair) {
            result = traced(operation, first, nullptr);
            return;
        }
        const TracedValue second{traces_[depth_ + 1], right};
        result = traced(operation, first, &second);
    }

    /// Traces an operand. One whose number is not known may be any variable.
    void trace_operand(bool has_known_number) {
        if (traces_.empty()) return;
        std::string identity = parameters_.identity();
        if (!has_known_number) identity = no_identity;
        traces_[depth_] = {std::move(identity), false, std::nullopt};
    }

    Value pop() { return values_[--depth_]; }

    core::Result<void> push(Value value, core::SourceSpan where) {
        if (depth_ == deepest)
            return core::fail(ErrorCode::invalid_value,
                              "this expression is nested too deeply: split it into steps", where);
        values_[depth_++] = value;
        return {};
    }

    core::Result<void> load(const Instruction& step, core::SourceSpan where) {
        if (step.operation == Operation::number) {
            if (!traces_.empty() && depth_ < deepest) traces_[depth_] = {};
            return push(step.number, where);
        }
        Value value;
        bool has_known_number = true;
        if (step.operation == Operation::exists) {
            value = truth(parameters_.exists(pool_.names[step.name]));
        } else if (step.operation == Operation::named) {
            FEELER_TRY(value, parameters_.named(pool_.names[step.name], where));
        } else {
            const double number = pop().value_or(0.0);
            has_known_number = traces_.empty() || traces_[depth_].identity.empty();
            FEELER_TRY(value, parameters_.numbered(number, where));
        }
        if (depth_ < deepest) trace_operand(has_known_number);
        return push(value, where);
    }

    /// Fanuc: a vacant variable equals only another vacant one, not 0.
    bool is_comparison_with_vacant(Operation operation, Value left, Value right) {
        if (operation != Operation::equal && operation != Operation::not_equal) return false;
        if (left && right) return false;
        const bool same = !left && !right;
        values_[depth_++] = truth(same == (operation == Operation::equal));
        return true;
    }

    const ExpressionPool& pool_;
    const uint32_t line_;
    const ParameterReader& parameters_;
    const Arithmetic& arithmetic_;
    Margins* margins_;
    std::array<Value, deepest> values_;
    std::vector<Trace> traces_; // of the values; empty if nothing is traced
    size_t depth_ = 0;
};

} // namespace

core::Result<Value> evaluate(const ExpressionPool& pool, Expression expression, uint32_t line,
                             const ParameterReader& parameters, const Arithmetic& arithmetic,
                             Margins* margins, Trace* trace) {
    Stack stack(pool, line, parameters, arithmetic, margins, trace != nullptr);
    for (uint32_t i = 0; i < expression.count; ++i)
        if (auto done = stack.apply(pool.instructions[expression.first + i]); !done)
            return tl::unexpected(std::move(done).error());
    if (trace) *trace = stack.top_trace();
    return stack.top();
}

} // namespace gcode

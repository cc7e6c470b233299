#include "gcode/language/expression_parser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include <fmt/format.h>

#include "gcode/language/expression_reader.h"

namespace gcode {

using core::ErrorCode;
using enum Operation;

core::Result<void> ExpressionReader::expect(char wanted) {
    if (lexer_.accept(wanted)) return {};
    return core::fail(ErrorCode::syntax, fmt::format("a '{}' is missing here", wanted),
                      lexer_.span(lexer_.at, lexer_.at + 1));
}

/// Reads the next operator if its rank is at least `lowest_rank`; null otherwise.
const Operator* ExpressionReader::next_operator(int lowest_rank) {
    for (const Operator& candidate : operators_of(syntax_)) {
        Lexer ahead = lexer_;
        if (!ahead.accept_word(candidate.spelling)) continue;
        if (syntax_ == ExpressionSyntax::siemens && is_letter(candidate.spelling.back())
            && ahead.at < ahead.line.size() && is_name_part(ahead.line[ahead.at])
            && !is_digit(ahead.line[ahead.at]))
            continue; // ORIWKS is not OR
        if (syntax_ == ExpressionSyntax::siemens && candidate.spelling == "<"
            && ahead.at < ahead.line.size() && ahead.line[ahead.at] == '<')
            return nullptr; // << joins texts
        if (candidate.rank < lowest_rank) return nullptr;
        lexer_ = ahead;
        return &candidate;
    }
    return nullptr;
}

/// Operators of equal rank associate to the left, including powers.
core::Result<void> ExpressionReader::expression(int lowest_rank) {
    if (auto done = value(); !done) return done;
    while (true) {
        lexer_.peek();
        const size_t column = lexer_.at;
        const Operator* found = next_operator(lowest_rank);
        if (!found) return {};
        if (auto done = expression(found->rank + 1); !done) return done;
        emit(found->operation, column);
    }
}

core::Result<void> ExpressionReader::brackets() {
    lexer_.peek();
    if (++depth_ > deepest)
        return core::fail(ErrorCode::syntax,
                          "brackets are nested too deeply here: split the expression into steps",
                          lexer_.span(lexer_.at, lexer_.at + 1));
    if (auto done = expect(open()); !done) return done;
    if (auto done = expression(0); !done) return done;
    --depth_;
    return expect(close());
}

core::Result<void> ExpressionReader::parameter() {
    const size_t begin = lexer_.at++;
    if (++depth_ > deepest)
        return core::fail(
            ErrorCode::syntax,
            "parameters of parameters are nested too deeply here: split the expression into steps",
            lexer_.span(begin, begin + 1));
    if (lexer_.peek() == '<') {
        FEELER_TRY(std::string name, parse_name(lexer_));
        pool_.instructions.push_back({named, static_cast<uint32_t>(begin + 1), 0.0,
                                      static_cast<uint32_t>(pool_.names.size())});
        pool_.names.push_back(std::move(name));
    } else {
        if (auto done = value(); !done) return done;
        emit(numbered, begin);
    }
    --depth_;
    return {};
}

/// `ATAN[y]/[x]`; Fanuc also has `ATAN[y, x]` and `ATAN[y]`.
core::Result<void> ExpressionReader::arc_tangent(size_t column) {
    const bool fanuc = syntax_ == ExpressionSyntax::fanuc;
    if (auto done = expect(open()); !done) return done;
    if (auto done = expression(0); !done) return done;
    if (fanuc && lexer_.accept(',')) {
        if (auto done = expression(0); !done) return done;
        if (auto done = expect(close()); !done) return done;
    } else {
        if (auto done = expect(close()); !done) return done;
        Lexer ahead = lexer_;
        if (ahead.accept('/') && ahead.peek() == open()) {
            lexer_ = ahead;
            if (auto done = brackets(); !done) return done;
        } else if (fanuc) {
            emit(Operation::arc_tangent_of_one, column);
            return {};
        } else {
            return core::fail(ErrorCode::syntax, "ATAN needs two values here: ATAN[y]/[x]",
                              lexer_.span(column, lexer_.at));
        }
    }
    emit(Operation::arc_tangent, column);
    return {};
}

core::Result<void> ExpressionReader::exists(size_t column) {
    if (auto done = expect(open()); !done) return done;
    if (!lexer_.accept('#'))
        return core::fail(ErrorCode::syntax,
                          "EXISTS needs a parameter: EXISTS[#<name>] or EXISTS[#5]",
                          lexer_.span(column, lexer_.at));
    if (lexer_.peek() != '<') {
        if (auto done = value(); !done) return done;
        emit(Operation::exists_numbered, column);
        return expect(close());
    }
    FEELER_TRY(std::string name, parse_name(lexer_));
    pool_.instructions.push_back({Operation::exists, static_cast<uint32_t>(column + 1), 0.0,
                                  static_cast<uint32_t>(pool_.names.size())});
    pool_.names.push_back(std::move(name));
    return expect(close());
}

/// `Q5`, `PI`, or a function of the following operand: `SIN Q5`, `SQRT(...)`.
core::Result<void> ExpressionReader::klartext_operand() {
    const size_t begin = lexer_.at;
    if (upper(lexer_.line[begin]) == 'Q') {
        FEELER_TRY(const int number, parse_q_parameter(lexer_));
        push(number, begin);
        emit(numbered, begin);
        return {};
    }
    if (lexer_.accept_word("PI")) {
        push(std::numbers::pi, begin);
        return {};
    }
    for (const Function& candidate : functions_of(syntax_)) {
        if (!lexer_.accept_word(candidate.name)) continue;
        if (++depth_ > deepest) return lexer_.unexpected_character();
        if (auto done = value(); !done) return done;
        --depth_;
        if (candidate.operation == Operation::arc_tangent) push(1.0, begin);
        emit(candidate.operation, begin);
        return {};
    }
    const std::string letters = lexer_.letters();
    return core::fail(ErrorCode::syntax, fmt::format("there is no function '{}'", letters),
                      lexer_.span(begin, begin + letters.size()));
}

core::Result<void> ExpressionReader::function() {
    if (syntax_ == ExpressionSyntax::klartext) return klartext_operand();
    if (syntax_ == ExpressionSyntax::siemens) return siemens_operand();
    const size_t begin = lexer_.at;
    if (lexer_.accept_word("ATAN")) return arc_tangent(begin);
    if (lexer_.accept_word("EXISTS")) return exists(begin);
    if (syntax_ == ExpressionSyntax::fanuc && lexer_.accept_word("POW")) {
        if (auto done = expect('['); !done) return done;
        if (auto done = expression(0); !done) return done;
        if (auto done = expect(','); !done) return done;
        if (auto done = expression(0); !done) return done;
        emit(power, begin);
        return expect(']');
    }
    for (const Function& candidate : functions_of(syntax_)) {
        Lexer ahead = lexer_;
        if (!ahead.accept_word(candidate.name) || ahead.peek() != open()) continue;
        lexer_ = ahead;
        if (auto done = brackets(); !done) return done;
        emit(candidate.operation, begin);
        return {};
    }
    const std::string letters = lexer_.letters();
    return core::fail(ErrorCode::syntax, fmt::format("there is no function '{}'", letters),
                      lexer_.span(begin, begin + letters.size()));
}

core::Result<void> ExpressionReader::number() {
    const size_t begin = lexer_.at;
    FEELER_TRY(const Number found, lexer_.number());
    pool_.instructions.push_back(
        {Operation::number, static_cast<uint32_t>(begin + 1), found.value});
    return {};
}

core::Result<void> ExpressionReader::value() {
    const char c = lexer_.peek();
    const size_t begin = lexer_.at;
    if (c == open()) return brackets();
    if (c == '#') return parameter();
    if (c == '+' || c == '-') {
        Lexer ahead = lexer_;
        ++ahead.at;
        const char next = ahead.peek();
        const bool sign = next == '+' || next == '-';
        if (next == '#' || next == open() || begins_operand(next) || sign) {
            if (++depth_ > deepest) return lexer_.unexpected_character();
            lexer_ = ahead;
            auto done = value();
            --depth_;
            if (done && c == '-') emit(negate, begin);
            return done;
        }
    }
    if (lexer_.is_at_number()) return number();
    if (begins_operand(c)) return function();
    return lexer_.unexpected_character();
}

core::Result<Expression> parse_value(Lexer& lexer, ExpressionSyntax syntax, ExpressionPool& pool,
                                     Number& number) {
    if (lexer.is_at_number()) {
        Lexer ahead = lexer;
        if (auto plain = ahead.number()) {
            number = *plain;
            lexer = ahead;
            return Expression{};
        }
        const char next = (++(ahead = lexer).at, ahead.peek());
        if (std::string_view("#[(+-_$'").find(next) == std::string_view::npos && !is_letter(next))
            return tl::unexpected(std::move(lexer.number()).error());
    }
    const auto first = static_cast<uint32_t>(pool.instructions.size());
    if (auto done = ExpressionReader(lexer, syntax, pool).value(); !done)
        return tl::unexpected(std::move(done).error());
    number.has_point = true; // a computed value is in full units
    return Expression{first, static_cast<uint32_t>(pool.instructions.size()) - first};
}

core::Result<Expression> parse_sum(Lexer& lexer, ExpressionSyntax syntax, ExpressionPool& pool,
                                   Number& number) {
    const auto first = static_cast<uint32_t>(pool.instructions.size());
    if (auto done = ExpressionReader(lexer, syntax, pool).expression(0); !done)
        return tl::unexpected(std::move(done).error());
    if (pool.instructions.size() == first + 1
        && pool.instructions[first].operation == Operation::number) {
        number.value = pool.instructions[first].number;
        pool.instructions.pop_back();
        return Expression{};
    }
    number.has_point = true;
    return Expression{first, static_cast<uint32_t>(pool.instructions.size()) - first};
}

core::Result<Expression> parse_bracketed(Lexer& lexer, ExpressionSyntax syntax,
                                         ExpressionPool& pool) {
    const auto first = static_cast<uint32_t>(pool.instructions.size());
    if (auto done = ExpressionReader(lexer, syntax, pool).brackets(); !done)
        return tl::unexpected(std::move(done).error());
    return Expression{first, static_cast<uint32_t>(pool.instructions.size()) - first};
}

core::Result<int> parse_q_parameter(Lexer& lexer) {
    constexpr int highest = 1999, highest_stored = 499;
    const size_t begin = lexer.at++;
    const char kind = lexer.at < lexer.line.size() ? upper(lexer.line[lexer.at]) : '\0';
    if (kind == 'R' || kind == 'L' || kind == 'S') ++lexer.at;
    if (kind == 'L' || kind == 'S')
        return core::fail(ErrorCode::unsupported,
                          fmt::format("'{}': {} are not supported yet: use Q0 to Q99",
                                      lexer.written_from(begin),
                                      kind == 'L' ? "local QL parameters" : "QS string parameters"),
                          lexer.span_from(begin));
    if (lexer.at >= lexer.line.size() || !is_digit(lexer.line[lexer.at]))
        return core::fail(
            ErrorCode::syntax,
            fmt::format("'{}' must be followed by a number: Q parameters are Q0 to Q{}",
                        lexer.written_from(begin), highest),
            lexer.span_from(begin));
    FEELER_TRY(const Number number, lexer.number());
    const double last = kind == 'R' ? highest_stored : highest;
    if (number.value > last || number.value != std::floor(number.value))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("'{}': the highest number of these Q parameters is {}",
                                      lexer.written_from(begin), last),
                          lexer.span_from(begin));
    const int index = static_cast<int>(number.value);
    return kind == 'R' ? first_stored_q + index : index == 0 ? q_zero : index;
}

core::Result<std::string> parse_name(Lexer& lexer) {
    const size_t begin = lexer.at;
    lexer.accept('<');
    std::string name;
    while (lexer.peek() != '>') {
        if (lexer.peek() == '\0')
            return core::fail(
                ErrorCode::syntax,
                fmt::format("the name '{}' has no closing '>'", lexer.written_from(begin)),
                lexer.span_from(begin));
        name.push_back(lower(lexer.line[lexer.at++]));
    }
    ++lexer.at;
    if (name.empty())
        return core::fail(ErrorCode::syntax, "there is no name between '<' and '>'",
                          lexer.span_from(begin));
    return name;
}

namespace {

using enum Operation;

// Of two with the same beginning, the longer one comes first.
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

// Of two with the same beginning, the longer one comes first. ATAN is the arc tangent of y over 1.
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

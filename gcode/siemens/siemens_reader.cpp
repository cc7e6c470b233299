#include "gcode/siemens/siemens_reader.h"

#include <algorithm>
#include <array>
#include <numbers>

#include <fmt/format.h>

#include "gcode/language/expression_parser.h"
#include "gcode/language/expression_reader.h"

namespace gcode {

bool SiemensReader::accept_name(std::string_view name) {
    next();
    if (siemens_name_at(lexer) != name) return false;
    lexer.at += name.size();
    return true;
}

bool SiemensReader::is_at_equals() {
    if (next() != '=') return false;
    return lexer.at + 1 >= lexer.line.size() || lexer.line[lexer.at + 1] != '=';
}

core::Result<void> SiemensReader::expect(char wanted, std::string_view after) {
    if (lexer.accept(wanted)) return {};
    return core::fail(core::ErrorCode::syntax,
                      fmt::format("'{}' is missing after '{}'", wanted, after),
                      lexer.span(lexer.at, lexer.at + 1));
}

core::Result<SiemensArgument> SiemensReader::argument() {
    SiemensArgument result;
    const char c = next();
    const size_t begin = lexer.at;
    if (c == '"') {
        const size_t end = lexer.line.find('"', begin + 1);
        if (end == std::string_view::npos)
            return refuse(fmt::format("the string {} is not closed: a '\"' is missing",
                                      lexer.line.substr(begin)),
                          begin);
        lexer.at = end + 1;
        result.kind = SiemensArgument::Kind::text;
        result.text = lexer.line.substr(begin + 1, end - begin - 1);
    } else {
        Number plain;
        FEELER_TRY(result.expression, parse_sum(lexer, dialect.expressions, block.pool, plain));
        result.kind = SiemensArgument::Kind::value;
        result.plain = plain.value;
    }
    result.span = lexer.span_from(begin);
    return result;
}

core::Result<void> SiemensReader::arguments(std::vector<SiemensArgument>& values) {
    const size_t begin = lexer.at++;
    if (lexer.accept(')')) return {};
    while (true) {
        const char c = next();
        if (c == ',' || c == ')') {
            values.push_back({.span = lexer.span(lexer.at, lexer.at + 1)});
        } else {
            FEELER_TRY(const SiemensArgument value, argument());
            values.push_back(value);
        }
        // `"R1 is "<<R1`: concatenation of strings.
        while (next() == '<' && lexer.line.substr(lexer.at).starts_with("<<")) {
            lexer.at += 2;
            FEELER_TRY(const SiemensArgument part, argument());
            values.push_back(part);
        }
        if (lexer.accept(')')) return {};
        if (!lexer.accept(','))
            return refuse(fmt::format("'{}' is not closed: a ',' or ')' is missing",
                                      lexer.line.substr(begin)),
                          begin);
    }
}

namespace {

using core::ErrorCode;

struct NamedFunction {
    std::string_view name;
    Operation operation;
    int arguments;
};

// SINUMERIK 840D sl, Programming Manual Job Planning, "Arithmetic functions".
constexpr NamedFunction siemens_functions[] = {
    {"ABS", Operation::absolute, 1},      {"ACOS", Operation::arc_cosine, 1},
    {"ASIN", Operation::arc_sine, 1},     {"ATAN2", Operation::arc_tangent, 2},
    {"COS", Operation::cosine, 1},        {"EXP", Operation::exponential, 1},
    {"LN", Operation::logarithm, 1},      {"MAXVAL", Operation::greatest, 2},
    {"MINVAL", Operation::least, 2},      {"POT", Operation::square, 1},
    {"ROUND", Operation::round, 1},       {"ROUNDUP", Operation::fup, 1},
    {"SIN", Operation::sine, 1},          {"SQRT", Operation::square_root, 1},
    {"TAN", Operation::tangent, 1},       {"TRUNC", Operation::truncate, 1},
    {"TRUNCREAL", Operation::truncate, 1}};

constexpr int highest_r = 19999;

} // namespace

std::string siemens_name_at(const Lexer& lexer) {
    std::string name;
    for (size_t at = lexer.at; at < lexer.line.size(); ++at) {
        const char c = lexer.line[at];
        if (!is_name_part(c) && !(c == '$' && at == lexer.at)) break;
        name.push_back(upper(c));
    }
    return name;
}

/// `'HFF'` and `'B101'`.
core::Result<void> ExpressionReader::siemens_constant() {
    const size_t begin = lexer_.at++;
    const char kind = lexer_.at < lexer_.line.size() ? upper(lexer_.line[lexer_.at]) : '\0';
    const int base = kind == 'H' ? 16 : 2;
    double value = 0.0;
    size_t digits = 0;
    for (++lexer_.at; lexer_.at < lexer_.line.size() && is_name_part(lexer_.line[lexer_.at]);
         ++lexer_.at, ++digits) {
        const char c = upper(lexer_.line[lexer_.at]);
        const int digit = is_digit(c) ? c - '0' : c - 'A' + 10;
        if (digit >= base) break;
        value = value * base + digit;
    }
    const bool ends = lexer_.at < lexer_.line.size() && lexer_.line[lexer_.at] == '\'';
    if ((kind != 'H' && kind != 'B') || digits == 0 || digits > 8 || !ends)
        return core::fail(ErrorCode::syntax,
                          "quotes must hold H and hexadecimal digits or B and binary digits, as in "
                          "'HFF' or 'B101'",
                          lexer_.span(begin, std::min(lexer_.at + 1, lexer_.line.size())));
    ++lexer_.at;
    push(value, begin);
    return {};
}

/// `R5` and `R[...]`; the R has been read.
core::Result<void> ExpressionReader::siemens_parameter(size_t begin) {
    if (lexer_.peek() == '[') {
        ++lexer_.at;
        if (++depth_ > deepest) return lexer_.unexpected_character();
        if (auto done = expression(0); !done) return done;
        --depth_;
        if (auto done = expect(']'); !done) return done;
    } else {
        int number = 0;
        while (lexer_.at < lexer_.line.size() && is_digit(lexer_.line[lexer_.at])
               && number <= highest_r)
            number = number * 10 + (lexer_.line[lexer_.at++] - '0');
        if (number > highest_r)
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("'{}': the highest R parameter is R{}",
                                          lexer_.written_from(begin), highest_r),
                              lexer_.span_from(begin));
        push(number, begin);
    }
    emit(Operation::numbered, begin);
    return {};
}

core::Result<void> ExpressionReader::siemens_function(size_t begin, std::string_view name) {
    const auto found = std::find_if(std::begin(siemens_functions), std::end(siemens_functions),
                                    [&](const NamedFunction& some) { return some.name == name; });
    for (const std::string_view addressing : {"AC", "IC", "DC", "ACP", "ACN"})
        if (name == addressing)
            return core::fail(
                ErrorCode::unsupported,
                fmt::format(
                    "'{}' is not supported here: it can only be the whole value of an axis, "
                    "of I, J or K, or of AP= or RP=",
                    name),
                lexer_.span(begin, begin + name.size()));
    if (found == std::end(siemens_functions))
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("'{}': this function is not supported; supported are SIN, COS, TAN, ASIN, "
                        "ACOS, ATAN2, SQRT, POT, ABS, ROUND, TRUNC, LN, EXP, MINVAL and MAXVAL",
                        name),
            lexer_.span(begin, begin + name.size()));
    if (++depth_ > deepest) return lexer_.unexpected_character();
    if (auto done = expect('('); !done) return done;
    for (int i = 0; i < found->arguments; ++i) {
        if (i > 0)
            if (auto done = expect(','); !done) return done;
        if (auto done = expression(0); !done) return done;
    }
    --depth_;
    emit(found->operation, begin);
    return expect(')');
}

/// A variable; the index in brackets is part of the name of a system variable.
core::Result<void> ExpressionReader::siemens_name(size_t begin, std::string_view name) {
    std::string stored;
    for (const char c : name) stored.push_back(lower(c));
    if (name.front() == '$' && lexer_.peek() == '[') {
        const size_t end = lexer_.line.find(']', lexer_.at);
        if (end == std::string_view::npos) return expect(']');
        for (; lexer_.at <= end; ++lexer_.at)
            if (!is_blank(lexer_.line[lexer_.at])) stored.push_back(lower(lexer_.line[lexer_.at]));
    } else if (lexer_.peek() == '[') {
        return core::fail(ErrorCode::unsupported,
                          fmt::format("'{}[': arrays are not supported yet: use R parameters, "
                                      "R[...]",
                                      name),
                          lexer_.span(begin, lexer_.at + 1));
    }
    pool_.instructions.push_back({Operation::named, static_cast<uint32_t>(begin + 1), 0.0,
                                  static_cast<uint32_t>(pool_.names.size())});
    pool_.names.push_back(std::move(stored));
    return {};
}

core::Result<void> ExpressionReader::siemens_operand() {
    const size_t begin = lexer_.at;
    if (lexer_.line[begin] == '\'') return siemens_constant();
    const std::string name = siemens_name_at(lexer_);
    const char next = begin + 1 < lexer_.line.size() ? lexer_.line[begin + 1] : '\0';
    if (name.front() == 'R' && (is_digit(next) || next == '[')) {
        ++lexer_.at;
        return siemens_parameter(begin);
    }
    lexer_.at += name.size();
    if (name == "TRUE" || name == "FALSE") {
        push(name == "TRUE" ? 1.0 : 0.0, begin);
        return {};
    }
    if (name == "PI" || name == "$PI") {
        push(std::numbers::pi, begin);
        return {};
    }
    if (name == "NOT") {
        if (++depth_ > deepest) return lexer_.unexpected_character();
        if (auto done = value(); !done) return done;
        --depth_;
        emit(Operation::truth_not, begin);
        return {};
    }
    if (lexer_.peek() == '(') return siemens_function(begin, name);
    if (name.size() < 2)
        return core::fail(
            ErrorCode::syntax,
            fmt::format(
                "'{}' is not a value: R parameters have a number, variables start with two letters",
                name),
            lexer_.span_from(begin));
    return siemens_name(begin, name);
}

} // namespace gcode

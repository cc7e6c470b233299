#include "gcode/klartext/klartext_reader.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gcode/language/expression_parser.h"
#include "gcode/language/modal_state.h"
#include "gcode/text/program_text.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// `F500`, `FQ5`, `FMAX`, `FAUTO`, or an F without a value, which has no effect.
core::Result<void> read_feed(KlartextReader& reader) {
    Lexer& lexer = reader.lexer;
    const size_t from = lexer.at;
    const std::string letters = reader.letters();
    if (letters == "FU" || letters == "FZ")
        return reader.refuse(fmt::format("'{}': feed per revolution and per tooth is not supported "
                                         "yet: program the feed in mm/min",
                                         letters),
                             from, ErrorCode::unsupported);
    lexer.at = from + 1;
    if (reader.accept("MAX")) {
        reader.command.rapid = true;
        return {};
    }
    if (reader.accept("AUTO")) {
        reader.add_word('E', 0.0, from);
        return {};
    }
    const char next = upper(lexer.peek());
    if (!lexer.is_at_number() && next != 'Q') return {};
    return reader.word('F', from);
}

/// R0, RL and RR; the radius of CR and RND; or an R without a value, which has no effect.
core::Result<void> read_radius(KlartextReader& reader) {
    Lexer& lexer = reader.lexer;
    const size_t from = lexer.at;
    const std::string letters = reader.letters();
    if (letters == "RL" || letters == "RR")
        return reader.refuse(
            fmt::format("'{}': cutter radius compensation is not supported yet", letters), from,
            ErrorCode::unsupported);
    const CommandKind kind = reader.command.kind;
    const auto has_radius = std::any_of(reader.block.words.begin(), reader.block.words.end(),
                                        [](const Word& word) { return word.letter == 'R'; });
    ++lexer.at;
    if ((kind == CommandKind::arc_of_radius || kind == CommandKind::rounding) && !has_radius)
        return reader.word('R', from);
    if (!lexer.is_at_number()) return {};
    if (lexer.accept('0')) return {};
    return reader.refuse("'R' must be followed by 0 here: R0 means no radius compensation; R+ and "
                         "R- are not supported yet",
                         from, ErrorCode::unsupported);
}

core::Result<void> read_turn(KlartextReader& reader) {
    const size_t from = reader.lexer.at;
    reader.lexer.at += 2;
    if (reader.lexer.accept('+'))
        reader.command.turn = 1;
    else if (reader.lexer.accept('-'))
        reader.command.turn = -1;
    else
        return reader.refuse("'DR' needs a sign: DR+ is counterclockwise, DR- clockwise", from);
    return {};
}

/// Skips the words after an M code that belong to it and not to the motion.
core::Result<void> skip_arguments(KlartextReader& reader, int code) {
    if (code == 140) reader.lexer.at = reader.lexer.line.size(); // MB MAX; it is refused
    const std::string_view letters = code == 118                  ? "XYZABCUVW"
                                     : code == 120                ? "LA"
                                     : code == 124                ? "T"
                                     : code == 103 || code == 128 ? "F"
                                                                  : "";
    while (is_letter(reader.next())
           && letters.find(upper(reader.lexer.line[reader.lexer.at])) != std::string_view::npos) {
        while (letters.find(upper(reader.lexer.peek())) != std::string_view::npos
               && reader.lexer.peek() != '\0')
            ++reader.lexer.at;
        const size_t kept = reader.block.words.size();
        if (auto done = reader.word('M', reader.lexer.at); !done) return done;
        reader.block.words.resize(kept);
    }
    return {};
}

} // namespace

char KlartextReader::next() {
    while (true) {
        const char c = lexer.peek();
        if (c == ';') {
            const size_t from = lexer.at;
            const size_t end = std::min(lexer.line.find_first_of("\r\n", from), lexer.line.size());
            block.comments.push_back(
                {lexer.line.substr(from + 1, end - from - 1), lexer.span(from, end)});
            lexer.at = end;
        } else if (c == '~' || is_line_end(c)) {
            ++lexer.at;
        } else {
            return c;
        }
    }
}

std::string KlartextReader::letters() {
    std::string found;
    next();
    for (size_t at = lexer.at; at < lexer.line.size() && is_letter(lexer.line[at]); ++at)
        found.push_back(upper(lexer.line[at]));
    return found;
}

bool KlartextReader::accept(std::string_view keyword) {
    if (letters() != keyword) return false;
    lexer.at += keyword.size();
    return true;
}

bool KlartextReader::accept_prefix(std::string_view prefix) {
    if (!std::string_view(letters()).starts_with(prefix)) return false;
    lexer.at += prefix.size();
    return true;
}

void KlartextReader::add_word(char letter, double value, size_t from) {
    block.words.push_back({.letter = letter, .value = value, .span = span_from(from)});
}

core::Result<void> KlartextReader::word(char letter, size_t from, Addressing addressing) {
    Word entry{.letter = letter, .addressing = addressing};
    Number plain;
    const char c = upper(next());
    if (!lexer.is_at_number() && c != 'Q' && c != '(') {
        const std::string name(lexer.line.substr(from, std::max<size_t>(lexer.at - from, 1)));
        return refuse(fmt::format("'{}' must be followed by a number or a Q parameter", name),
                      from);
    }
    FEELER_TRY(entry.expression, parse_value(lexer, dialect.expressions, block.pool, plain));
    entry.value = plain.value;
    entry.has_point = plain.has_point;
    entry.span = span_from(from);
    const auto same = [&](const Word& other) { return other.letter == letter; };
    const bool repeatable = letter == 'M' || letter == 'G';
    if (!repeatable && std::any_of(block.words.begin(), block.words.end(), same))
        return refuse(fmt::format("'{}' appears twice in this block", lexer.written_from(from)),
                      from);
    block.words.push_back(entry);
    return {};
}

core::Result<Expression> KlartextReader::operand() {
    next();
    Number plain;
    FEELER_TRY(const Expression found, parse_value(lexer, dialect.expressions, block.pool, plain));
    if (found) return found;
    const auto first = static_cast<uint32_t>(block.pool.instructions.size());
    block.pool.instructions.push_back(
        {Operation::number, static_cast<uint32_t>(lexer.at), plain.value});
    return Expression{first, 1};
}

tl::unexpected<core::Error> KlartextReader::refuse(std::string message, size_t from,
                                                   core::ErrorCode code) {
    const size_t end = std::min(std::max(lexer.at, from + 1), lexer.line.size());
    return core::fail(code, std::move(message), lexer.span(from, end));
}

tl::unexpected<core::Error> KlartextReader::stray() {
    next();
    const size_t from = lexer.at;
    const std::string word = letters();
    if (word.empty() && lexer.is_at_number()) {
        if (!lexer.number()) ++lexer.at;
        return refuse(fmt::format("'{}' has no letter before it", lexer.written_from(from)), from);
    }
    if (word.empty()) return lexer.unexpected_character();
    return refuse(fmt::format("'{}' is not allowed in this block", word), from);
}

core::Result<void> read_m_word(KlartextReader& reader) {
    Lexer& lexer = reader.lexer;
    const size_t from = lexer.at++;
    if (!lexer.is_at_number()) return {}; // an M without a number has no effect
    FEELER_TRY(const Number number, lexer.number());
    const auto code = static_cast<int>(std::clamp(number.value, -1.0, 1e6));
    KlartextLine& command = reader.command;
    switch (code) {
    case 13: // M3 and M8
    case 14: // M4 and M8
        reader.add_word('M', code == 13 ? 3.0 : 4.0, from);
        reader.add_word('M', 8.0, from);
        return {};
    case 89:
        command.calls_from_here = true;
        return {};
    case 91:
        reader.add_word('G', 53.0, from);
        return {};
    case 97: // small steps in a compensated contour
    case 98: // open corners in a compensated contour
        return {};
    case 99:
        command.calls_cycle = true;
        return {};
    default:
        reader.add_word('M', number.value, from);
        return skip_arguments(reader, code);
    }
}

core::Result<void> read_contour_word(KlartextReader& reader) {
    const std::string letters = reader.letters();
    const size_t from = reader.lexer.at;
    const char first = letters[0];
    if (letters == "DR") return read_turn(reader);
    if (reader.accept_prefix("PR")) return reader.word('P', from);
    if (reader.accept_prefix("PA")) return reader.word('H', from);
    if (reader.accept_prefix("IPR")) return reader.word('P', from, Addressing::incremental);
    if (reader.accept_prefix("IPA")) return reader.word('H', from, Addressing::incremental);
    if (first == 'F') return read_feed(reader);
    if (first == 'R') return read_radius(reader);
    if (first == 'M') return read_m_word(reader);
    const bool incremental = first == 'I' && letters.size() > 1;
    const char axis = incremental ? letters[1] : first;
    if (axis_letters.find(axis) == std::string_view::npos) return reader.stray();
    reader.lexer.at += incremental ? 2 : 1;
    return reader.word(axis, from, incremental ? Addressing::incremental : Addressing::absolute);
}

core::Result<void> set_result(KlartextReader& reader, int target, Expression value) {
    Assignment entry;
    const auto at = static_cast<uint32_t>(reader.block.pool.instructions.size());
    reader.block.pool.instructions.push_back(
        {Operation::number, static_cast<uint32_t>(reader.begin + 1), double(target)});
    entry.number = {at, 1};
    entry.value = value;
    entry.span = reader.span_from(reader.begin);
    reader.block.assignments.push_back(entry);
    return {};
}

core::Result<int> read_target(KlartextReader& reader) {
    if (upper(reader.next()) != 'Q')
        return reader.refuse("this function needs a Q parameter for its result", reader.begin);
    FEELER_TRY(const int target, parse_q_parameter(reader.lexer));
    if (reader.next() == '=') {
        ++reader.lexer.at;
        return target;
    }
    return reader.refuse("the Q parameter must be followed by '='", reader.begin);
}

namespace {

/// The operators of FN 1 to FN 8 and FN 13.
struct ArithmeticFunction {
    int number;
    std::string_view sign; // empty: one operand after the name
    std::string_view name;
    Operation operation;
};

constexpr ArithmeticFunction arithmetic[] = {{1, "+", "", Operation::add},
                                             {2, "-", "", Operation::subtract},
                                             {3, "*", "", Operation::multiply},
                                             {4, "DIV", "", Operation::divide},
                                             {5, "", "SQRT", Operation::square_root},
                                             {6, "", "SIN", Operation::sine},
                                             {7, "", "COS", Operation::cosine},
                                             {8, "LEN", "", Operation::hypotenuse},
                                             {13, "ANG", "", Operation::arc_tangent}};

core::Result<void> read_arithmetic(KlartextReader& reader, const ArithmeticFunction& function) {
    FEELER_TRY(const int target, read_target(reader));
    reader.next();
    if (!function.name.empty() && !reader.accept_prefix(function.name))
        return reader.refuse(
            fmt::format("'FN {}' must be written with {}", function.number, function.name),
            reader.begin);
    const auto first = static_cast<uint32_t>(reader.block.pool.instructions.size());
    if (auto left = reader.operand(); !left) return tl::unexpected(std::move(left).error());
    if (!function.sign.empty()) {
        reader.next();
        if (!reader.lexer.accept_word(function.sign))
            return reader.refuse(fmt::format("'FN {}' needs {} between its two values",
                                             function.number, function.sign),
                                 reader.begin);
        if (auto right = reader.operand(); !right) return tl::unexpected(std::move(right).error());
    }
    auto& steps = reader.block.pool.instructions;
    const auto column = static_cast<uint32_t>(reader.begin + 1);
    steps.push_back({function.operation, column});
    if (function.number == 13) steps.push_back({Operation::full_turn, column});
    return set_result(reader, target, {first, static_cast<uint32_t>(steps.size()) - first});
}

struct Comparison {
    int number;
    std::string_view name;
    Operation operation;
};

constexpr Comparison comparisons[] = {{9, "EQU", Operation::equal},
                                      {10, "NE", Operation::not_equal},
                                      {11, "GT", Operation::greater},
                                      {12, "LT", Operation::less}};

/// `IF +Q1 EQU +Q2 GOTO LBL 5`
core::Result<void> read_jump(KlartextReader& reader, const Comparison& comparison) {
    const auto wrong = [&] {
        return reader.refuse(fmt::format("'FN {}' must be written as IF a {} b GOTO LBL n",
                                         comparison.number, comparison.name),
                             reader.begin);
    };
    if (!reader.accept("IF")) return wrong();
    const auto first = static_cast<uint32_t>(reader.block.pool.instructions.size());
    if (auto left = reader.operand(); !left) return tl::unexpected(std::move(left).error());
    if (!reader.accept(comparison.name)) return wrong();
    if (auto right = reader.operand(); !right) return tl::unexpected(std::move(right).error());
    auto& steps = reader.block.pool.instructions;
    steps.push_back({comparison.operation, static_cast<uint32_t>(reader.begin + 1)});
    Flow& flow = reader.block.flow;
    flow.condition = {first, static_cast<uint32_t>(steps.size()) - first};
    flow.has_condition = true;
    if (!reader.accept("GOTO") || !reader.accept("LBL")) return wrong();
    if (auto named = read_label_name(reader); !named) return named;
    flow.kind = FlowKind::if_go_to_label;
    flow.span = reader.span_from(reader.begin);
    return {};
}

/// `SYSREAD Q10 = ID270 NR1 IDX2`
core::Result<void> read_system_datum(KlartextReader& reader) {
    reader.accept("SYSREAD");
    FEELER_TRY(const int target, read_target(reader));
    reader.add_word('Q', target, reader.begin);
    for (const auto& [name, letter] :
         {std::pair<std::string_view, char>{"ID", 'I'}, {"NR", 'N'}, {"IDX", 'K'}}) {
        const size_t from = (reader.next(), reader.lexer.at);
        if (!reader.accept_prefix(name)) continue;
        if (auto done = reader.word(letter, from); !done) return done;
    }
    reader.command.kind = CommandKind::read_system;
    return {};
}

core::Result<void> read_error(KlartextReader& reader) {
    reader.accept("ERROR");
    reader.lexer.accept('=');
    reader.command.kind = CommandKind::program_error;
    return reader.word('P', reader.begin);
}

} // namespace

core::Result<void> read_function(KlartextReader& reader) {
    reader.accept("FN");
    FEELER_TRY(const int number, read_whole(reader, "FN"));
    if (reader.next() == ':') ++reader.lexer.at;
    reader.command.span = reader.span_from(reader.begin);
    if (number == 0) {
        FEELER_TRY(const int target, read_target(reader));
        FEELER_TRY(const Expression value, reader.operand());
        return set_result(reader, target, value);
    }
    for (const ArithmeticFunction& function : arithmetic)
        if (function.number == number) return read_arithmetic(reader, function);
    for (const Comparison& comparison : comparisons)
        if (comparison.number == number) return read_jump(reader, comparison);
    if (number == 14) return read_error(reader);
    if (number == 18) return read_system_datum(reader);
    if (number == 15 || number == 16 || number == 20) { // prints or waits for the machine
        reader.lexer.at = reader.lexer.line.size();
        reader.command.kind = CommandKind::note;
        return {};
    }
    return reader.refuse(fmt::format("'FN {}' is not supported yet", number), reader.begin,
                         ErrorCode::unsupported);
}

core::Result<void> read_assignment(KlartextReader& reader) {
    FEELER_TRY(const int target, read_target(reader));
    reader.next();
    Number plain;
    const auto first = static_cast<uint32_t>(reader.block.pool.instructions.size());
    FEELER_TRY(Expression value,
               parse_sum(reader.lexer, reader.dialect.expressions, reader.block.pool, plain));
    if (!value) {
        reader.block.pool.instructions.push_back(
            {Operation::number, static_cast<uint32_t>(reader.begin + 1), plain.value});
        value = {first, 1};
    }
    return set_result(reader, target, value);
}

} // namespace gcode

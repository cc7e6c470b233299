#include <fmt/format.h>

#include "gcode/expression_parser.h"
#include "gcode/klartext_reader.h"

namespace gcode {

using core::ErrorCode;

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
        return reader.refuse("this function needs the Q parameter that takes its result",
                             reader.begin);
    FEELER_TRY(const int target, parse_q_parameter(reader.lexer));
    if (reader.next() == '=') {
        ++reader.lexer.at;
        return target;
    }
    return reader.refuse("a '=' is missing behind the Q parameter", reader.begin);
}

namespace {

/// What FN 1 to FN 8 and FN 13 write between their operands.
struct Function {
    int number;
    std::string_view sign; // empty: there is one operand, after the name
    std::string_view name;
    Operation operation;
};

constexpr Function arithmetic[] = {{1, "+", "", Operation::add},
                                   {2, "-", "", Operation::subtract},
                                   {3, "*", "", Operation::multiply},
                                   {4, "DIV", "", Operation::divide},
                                   {5, "", "SQRT", Operation::square_root},
                                   {6, "", "SIN", Operation::sine},
                                   {7, "", "COS", Operation::cosine},
                                   {8, "LEN", "", Operation::hypotenuse},
                                   {13, "ANG", "", Operation::arc_tangent}};

core::Result<void> read_arithmetic(KlartextReader& reader, const Function& function) {
    FEELER_TRY(const int target, read_target(reader));
    reader.next();
    if (!function.name.empty() && !reader.accept_prefix(function.name))
        return reader.refuse(
            fmt::format("'FN {}' computes with {}", function.number, function.name), reader.begin);
    const auto first = static_cast<uint32_t>(reader.block.pool.instructions.size());
    if (auto left = reader.operand(); !left) return tl::unexpected(std::move(left).error());
    if (!function.sign.empty()) {
        reader.next();
        if (!reader.lexer.accept_word(function.sign))
            return reader.refuse(fmt::format("'FN {}' needs a {} between its two values",
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
        return reader.refuse(
            fmt::format("'FN {}' reads IF a {} b GOTO LBL n", comparison.number, comparison.name),
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
    reader.block.command.kind = CommandKind::read_system;
    return {};
}

core::Result<void> read_error(KlartextReader& reader) {
    reader.accept("ERROR");
    reader.lexer.accept('=');
    reader.block.command.kind = CommandKind::program_error;
    return reader.word('P', reader.begin);
}

} // namespace

core::Result<void> read_function(KlartextReader& reader) {
    reader.accept("FN");
    FEELER_TRY(const int number, read_whole(reader, "FN"));
    if (reader.next() == ':') ++reader.lexer.at;
    reader.block.command.span = reader.span_from(reader.begin);
    if (number == 0) {
        FEELER_TRY(const int target, read_target(reader));
        FEELER_TRY(const Expression value, reader.operand());
        return set_result(reader, target, value);
    }
    for (const Function& function : arithmetic)
        if (function.number == number) return read_arithmetic(reader, function);
    for (const Comparison& comparison : comparisons)
        if (comparison.number == number) return read_jump(reader, comparison);
    if (number == 14) return read_error(reader);
    if (number == 18) return read_system_datum(reader);
    if (number == 15 || number == 16 || number == 20) { // prints, or waits for the machine
        reader.lexer.at = reader.lexer.line.size();
        reader.block.command.kind = CommandKind::note;
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

#pragma once

#include "gcode/language/expression_parser.h"

namespace gcode {

/// Parses expressions of all controls into postfix steps.
class ExpressionReader {
public:
    ExpressionReader(Lexer& lexer, ExpressionSyntax syntax, ExpressionPool& pool)
        : lexer_(lexer), syntax_(syntax), pool_(pool) {}

    core::Result<void> value();
    core::Result<void> brackets();
    core::Result<void> expression(int lowest_rank);

private:
    bool round_brackets() const {
        return syntax_ == ExpressionSyntax::siemens || syntax_ == ExpressionSyntax::klartext;
    }
    char open() const { return round_brackets() ? '(' : '['; }
    char close() const { return round_brackets() ? ')' : ']'; }

    /// Whether a function, parameter or name begins with this character.
    bool begins_operand(char c) const {
        if (is_letter(c)) return true;
        return syntax_ == ExpressionSyntax::siemens && (c == '_' || c == '$' || c == '\'');
    }

    void emit(Operation operation, size_t column) {
        pool_.instructions.push_back({operation, static_cast<uint32_t>(column + 1)});
    }

    const Operator* next_operator(int lowest_rank);
    core::Result<void> parameter();
    core::Result<void> function();
    core::Result<void> klartext_operand();
    core::Result<void> siemens_operand();
    core::Result<void> siemens_constant();
    core::Result<void> siemens_parameter(size_t begin);
    core::Result<void> siemens_function(size_t begin, std::string_view name);
    core::Result<void> siemens_name(size_t begin, std::string_view name);
    void push(double value, size_t begin) {
        pool_.instructions.push_back({Operation::number, static_cast<uint32_t>(begin + 1), value});
    }
    core::Result<void> arc_tangent(size_t column);
    core::Result<void> number();
    core::Result<void> exists(size_t column);
    core::Result<void> expect(char wanted);

    Lexer& lexer_;
    const ExpressionSyntax syntax_;
    ExpressionPool& pool_;
    static constexpr int deepest = 48; // nested brackets; each level takes a few calls of functions
    int depth_ = 0;
};

} // namespace gcode

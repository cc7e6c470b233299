#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/language/block.h"

namespace gcode {

/// A flow statement and its line.
struct FlowMark {
    FlowKind kind = FlowKind::none;
    std::string name;
    uint32_t line = 0;
    uint32_t scope = 0;          // line of the `sub` around it; 0 outside
    bool closes_do_loop = false; // a `while` that ends a `do`
    uint32_t partner = 0;        // Siemens: line of the statement it belongs with; 0 when missing
};

/// A block number.
struct NumberedLine {
    double number = 0.0;
    uint32_t line = 0;
};

/// Where a program's flow statements and block numbers are. Memory grows with these, not with the
/// lines.
struct FlowIndex {
    std::vector<FlowMark> marks;       // by line
    std::vector<NumberedLine> numbers; // by line

    /// The mark of a line; null when it has none.
    const FlowMark* at(uint32_t line) const;

    /// The next mark after a line, or the last one before it, of this scope and name that is one
    /// of these kinds; null when there is none.
    const FlowMark* next(uint32_t line, uint32_t scope, std::string_view name,
                         std::initializer_list<FlowKind> kinds) const;
    const FlowMark* previous(uint32_t line, uint32_t scope, std::string_view name,
                             std::initializer_list<FlowKind> kinds) const;

    /// The first mark of a kind and name in the program.
    const FlowMark* first(FlowKind kind, std::string_view name) const;

    /// The line of the `sub` around a line; 0 outside.
    uint32_t scope_of(uint32_t line) const;

    /// The line with a block number: the first one from a line up to another.
    std::optional<uint32_t> line_of_number(double number, uint32_t from, uint32_t up_to) const;
};

struct Lexer;

/// The block number a line begins with, which is read with what switches the block off.
std::optional<double> take_block_number(Lexer& lexer);

/// The name of a label that is written as a number: 5, or 5.5.
std::string label_of(double number);

} // namespace gcode

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
    uint32_t scope = 0;          // line of the enclosing `sub`; 0 outside
    bool closes_do_loop = false; // a `while` that ends a `do`
    uint32_t partner = 0;        // Siemens: line of the matching statement; 0 if missing
};

/// A block number.
struct NumberedLine {
    double number = 0.0;
    uint32_t line = 0;
};

/// The positions of a program's flow statements and block numbers. Memory grows with their number,
/// not with the number of lines.
struct FlowIndex {
    std::vector<FlowMark> marks;       // sorted by line
    std::vector<NumberedLine> numbers; // sorted by line

    /// The mark of a line; null if it has none.
    const FlowMark* at(uint32_t line) const;

    /// The next mark after a line, or the last one before it, that has this scope, this name and
    /// one of these kinds; null if there is none.
    const FlowMark* next(uint32_t line, uint32_t scope, std::string_view name,
                         std::initializer_list<FlowKind> kinds) const;
    const FlowMark* previous(uint32_t line, uint32_t scope, std::string_view name,
                             std::initializer_list<FlowKind> kinds) const;

    /// The first mark in the program with this kind and name.
    const FlowMark* first(FlowKind kind, std::string_view name) const;

    /// The line of the `sub` that encloses a line; 0 outside.
    uint32_t scope_of(uint32_t line) const;

    /// The first line with a block number in a range of lines.
    std::optional<uint32_t> line_of_number(double number, uint32_t from, uint32_t up_to) const;
};

struct Lexer;

/// Reads the block number at the start of a line, and any block delete before it.
std::optional<double> take_block_number(Lexer& lexer);

/// The name of a numeric label: 5, or 5.5.
std::string label_of(double number);

} // namespace gcode

#pragma once

#include <string>
#include <vector>

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"
#include "gcode/language/flow_index.h"

namespace gcode {

/// Parses a block of Heidenhain Klartext. Lines joined by `~` are one text.
///
/// Effect: overwrites `block` except its line and text.
/// Errors: syntax with line, column and the text in question; unsupported for keywords, functions
///         and cycles that are not implemented.
core::Result<void> parse_klartext(std::string_view text, uint32_t line, const Dialect& dialect,
                                  Block& block);

/// The text of the block that starts at a line: `~` at the end of a line joins the next line to it.
std::string_view klartext_block(const Program& program, uint32_t line);

/// The number of lines of a block.
uint32_t lines_of(std::string_view text);

/// Converts a position in a block of several lines to its line and the column in that line.
core::SourceSpan position_in_lines(std::string_view text, core::SourceSpan where);

/// The words with which a statement can begin, also those that are refused, and `CYCL DEF n` for
/// each supported cycle.
std::vector<std::string> klartext_words();

/// The labels of a program.
FlowIndex klartext_index(const Program& program, const Dialect& dialect);

} // namespace gcode

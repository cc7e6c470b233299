#pragma once

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"
#include "gcode/read/flow_index.h"

namespace gcode {

/// Reads a block of Heidenhain Klartext. With the lines that `~` joins to it, it is one text.
///
/// Effect: `block` is overwritten but for its line and text.
/// Errors: syntax with line, column and what stands there; unsupported for keywords, functions and
///         cycles that this version does not carry out.
core::Result<void> parse_klartext(std::string_view text, uint32_t line, const Dialect& dialect,
                                  Block& block);

/// The text of a block that begins at a line: `~` at the end of a line joins the next one to it.
std::string_view klartext_block(const Program& program, uint32_t line);

/// How many lines a block has.
uint32_t lines_of(std::string_view text);

/// Where a place in a block of several lines is: its line, and the column in that.
core::SourceSpan place_in_lines(std::string_view text, core::SourceSpan where);

/// The labels of a program.
FlowIndex klartext_index(const Program& program, const Dialect& dialect);

} // namespace gcode

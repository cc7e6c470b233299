#pragma once

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"
#include "gcode/language/flow_index.h"

namespace gcode {

/// Parses a line of native Siemens (SINUMERIK 840D).
///
/// Effect: overwrites `block` except its line and text.
/// Errors: syntax with line, column and the text in question; unsupported for keywords and cycles
///         that are not implemented.
core::Result<void> parse_siemens(std::string_view text, uint32_t line, const Dialect& dialect,
                                 Block& block);

/// The labels, block numbers, loops and branches of a program.
FlowIndex siemens_index(const Program& program, const Dialect& dialect);

} // namespace gcode

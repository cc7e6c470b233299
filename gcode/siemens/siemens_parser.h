#pragma once

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"
#include "gcode/read/flow_index.h"

namespace gcode {

/// Reads a line of native Siemens (SINUMERIK 840D).
///
/// Effect: `block` is overwritten but for its line and text.
/// Errors: syntax with line, column and what stands there; unsupported for keywords and cycles that
///         this version does not carry out.
core::Result<void> parse_siemens(std::string_view text, uint32_t line, const Dialect& dialect,
                                 Block& block);

/// The labels, block numbers, loops and branches of a program.
FlowIndex siemens_index(const Program& program, const Dialect& dialect);

} // namespace gcode

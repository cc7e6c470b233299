#pragma once

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"

namespace gcode {

/// Reads one line of a program.
///
/// Effect: `block` is overwritten; its vectors keep their room.
/// Errors: syntax with line, column and what stands there: a letter without a number, a second X
///         word, a comment without its end, an expression that is none.
core::Result<void> parse_line(std::string_view text, uint32_t line, const Dialect& dialect,
                              Block& block);

} // namespace gcode

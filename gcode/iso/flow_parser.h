#pragma once

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"
#include "gcode/language/lexer.h"

namespace gcode {

/// Reads a flow statement if one begins here: an O word of LinuxCNC, or IF, WHILE, DO, END and GOTO
/// of Fanuc. Returns whether there was one; if not, the lexer does not move.
///
/// Errors: syntax with the column of the mistake.
core::Result<bool> parse_flow(Lexer& lexer, const Dialect& dialect, Block& block);

/// Reads only the label and the keyword of an O word, ignoring the rest of the line.
core::Result<bool> parse_flow_head(Lexer& lexer, const Dialect& dialect, Block& block);

} // namespace gcode

#pragma once

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"
#include "gcode/language/lexer.h"

namespace gcode {

/// Reads a flow statement if one begins here: an O word of LinuxCNC, or IF, WHILE, DO, END and GOTO
/// of Fanuc. Says whether there was one; the lexer stays where it is when there was none.
///
/// Errors: syntax with the column at fault.
core::Result<bool> parse_flow(Lexer& lexer, const Dialect& dialect, Block& block);

/// Reads only the label and the keyword of an O word, whatever follows.
core::Result<bool> parse_flow_head(Lexer& lexer, const Dialect& dialect, Block& block);

} // namespace gcode

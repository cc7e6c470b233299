#pragma once

#include "gcode/block.h"

namespace gcode {

/// The words of one line. Blank lines and comments give a block without words.
///
/// Errors: those of Lexer::next; syntax when a letter other than G and M stands twice, or `/` or
///         `%` stands where it has no meaning; unsupported at flow control (O words with a
///         keyword).
core::Result<Block> parse_line(std::string_view text, uint32_t line);

} // namespace gcode

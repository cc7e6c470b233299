#pragma once

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"

namespace gcode {

/// Reads a line of letters with numbers, as most lines are, into an empty block. Returns false for
/// anything else or a mistake; the block is then unusable.
///
/// The words are the same as those of the general parser.
/// Cost: about a tenth of the general parser.
bool read_plain_words(std::string_view text, uint32_t line, const Dialect& dialect, Block& block);

} // namespace gcode

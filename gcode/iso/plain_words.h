#pragma once

#include "gcode/language/block.h"
#include "gcode/language/dialect.h"

namespace gcode {

/// Reads a line of letters with numbers, as most lines are, into an empty block; false if it has
/// anything else or a mistake, and the block is then unusable.
///
/// The words are those that the general parser gives.
/// Cost: about a tenth of the general parser's.
bool read_plain_words(std::string_view text, uint32_t line, const Dialect& dialect, Block& block);

} // namespace gcode

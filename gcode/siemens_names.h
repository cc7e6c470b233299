#pragma once

#include <string>

#include "gcode/lexer.h"

namespace gcode {

/// The name that stands here, in capitals: letters, digits and `_`, before them a `$` of the
/// control's own variables. It stays to be read.
std::string siemens_name_at(const Lexer& lexer);

} // namespace gcode

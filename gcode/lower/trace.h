#pragma once

#include <string>

#include "gcode/language/canonical.h"

namespace gcode {

/// A command on one line without line end, such as `straight_feed x=10 y=0 z=-1 feed=200`. Numbers
/// are rounded to a millionth; unknown coordinates are left out.
std::string to_text(const CanonicalCommand& command);

/// Appends to_text(command).
void append_text(const CanonicalCommand& command, std::string& text);

} // namespace gcode

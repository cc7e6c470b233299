#pragma once

#include <string>

#include "gcode/exec/interpreter.h"

namespace gcode {

/// A command on one line without line end, such as `straight_feed x=10 y=0 z=-1 feed=200`. Numbers
/// are rounded to a millionth; unknown coordinates are left out.
std::string to_text(const CanonicalCommand& command);

/// The commands of a program, one per line after the line number, followed by the warnings of each
/// block and the error that stopped the program. This is the format of golden files.
std::string to_text(const Run& run);

} // namespace gcode

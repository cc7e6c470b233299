#pragma once

#include <string>

#include "gcode/interpreter.h"

namespace app {

/// Appends the commands of a block, one a line: `6: straight_feed x=20 y=10 feed=150`.
void append_trace_text(const gcode::BlockResult& block, std::string& text);

/// Appends the commands of a block as JSON, one a line, keys as the design of the command line has
/// them. Lengths and angles to the last bit; bytes that are no UTF-8 are replaced.
void append_trace_json(const gcode::BlockResult& block, std::string& text);

} // namespace app

#pragma once

#include "gcode/interpreter.h"

namespace gcode {

/// The G code that is active in one of Fanuc's groups of modal codes, as #4001 and on show it; 54.1
/// for an extended work offset. Vacant for a group that nothing is known about.
Value fanuc_mode(const InterpreterState& state, int group);

} // namespace gcode

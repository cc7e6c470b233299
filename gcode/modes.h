#pragma once

#include "gcode/interpreter.h"

namespace gcode {

/// Puts back the modes that M70 and M73 save: units, plane, distances, feed, speed, retract level
/// and the like; not the place, the offsets or the tool.
void restore_modes(InterpreterState& state, const ModalState& saved);

} // namespace gcode

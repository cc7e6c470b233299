#pragma once

#include "gcode/interpreter.h"

namespace gcode {

/// Puts back the modes that M70 and M73 save: units, plane, distances, feed, speed, retract level
/// and the like; not the place, the offsets or the tool.
void restore_modes(InterpreterState& state, const ModalState& saved);

/// Says by commands what restored modes mean for the machine.
void announce_modes(BlockResult& result, uint32_t column, const ModalState& before,
                    const ModalState& after);

} // namespace gcode

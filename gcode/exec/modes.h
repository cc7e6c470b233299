#pragma once

#include <string>
#include <vector>

#include "gcode/exec/interpreter.h"

namespace gcode {

/// Restores what M70 and M73 saved, as LinuxCNC does: modes, feed and speed with the digits it
/// keeps of them, spindle, coolant, overrides, the active work offset, and whether G92 and a tool
/// length offset are active; not the position, the tool, or the values of the offsets.
void restore_modes(InterpreterState& state, const ModalState& saved);

/// Warnings about what restoring the modes does not restore, one sentence each.
std::vector<std::string> losses_of_restoring(const ModalState& now, const ModalState& saved);

/// Emits the commands for restored modes.
void announce_modes(BlockCommands& result, uint32_t column, const ModalState& before,
                    const ModalState& after);

/// The G code that is active in one of Fanuc's groups of modal codes, as #4001 and on show it; 54.1
/// for an extended work offset. Vacant for a group that nothing is known about.
Value fanuc_mode(const InterpreterState& state, int group);

} // namespace gcode

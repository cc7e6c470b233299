#pragma once

#include <string>
#include <vector>

#include "gcode/exec/interpreter.h"

namespace gcode {

/// Restores what M70 and M73 saved, as LinuxCNC does: modes, feed and speed (rounded), spindle,
/// coolant, overrides, the active work offset, and whether G92 and a tool length offset are active.
/// Does not restore the position, the tool, or the values of the offsets.
void restore_modes(InterpreterState& state, const ModalState& saved);

/// Warnings about what is lost when modes are restored, one sentence each.
std::vector<std::string> losses_of_restoring(const ModalState& now, const ModalState& saved);

/// Emits the commands for the restored modes.
void announce_modes(BlockCommands& result, uint32_t column, const ModalState& before,
                    const ModalState& after);

/// The active G code of one of Fanuc's groups of modal codes, as in #4001 and up; 54.1 for an
/// extended work offset. Vacant if the group is not modelled.
Value fanuc_mode(const InterpreterState& state, int group);

} // namespace gcode

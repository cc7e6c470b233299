#pragma once

#include "gcode/cycles/cycles.h"

namespace gcode {

/// Checks whether a canned cycle of LinuxCNC can run with the words of its block.
///
/// Errors: syntax for cutter radius compensation, axes outside the plane and a block without axis
///         words; missing_value for P of cycles that dwell, for I, J and K of G87, and for a
///         spindle that does not run as the cycle needs; invalid_value for a negative time.
/// Source: NISTIR 6556 (RS274/NGC v3), 3.5.16; behaves as LinuxCNC 2.9.
core::Result<void> check_rs274_cycle(const Execution& execution, const DrillingCycle& kind,
                                     const CannedCycle& cycle);

/// Sets exact path mode for a cycle, and restores the previous mode.
void begin_exact_path(Execution& execution);
void end_exact_path(Execution& execution);

/// G84 and G74: feed down, reverse the spindle, dwell for P, and feed out, with overrides off.
void tap_with_reversal(Drilling& hole);

/// G87: down off centre, feed up to K on centre, back down, and out off centre.
void bore_back_to_middle(Drilling& hole);

/// G88: the spindle and the program stop at the bottom. The control does not retract but assumes
/// afterwards that the tool is out of the hole.
void bore_and_stop(Drilling& hole);

} // namespace gcode

#pragma once

#include "gcode/cycles/cycles.h"

namespace gcode {

/// Whether a canned cycle of LinuxCNC can be carried out, with the words of its block.
///
/// Errors: syntax for cutter radius compensation, axes outside of the plane and a block without
///         axis words; missing_value for P of the cycles that wait, for I, J and K of G87, and for
///         a spindle that does not turn as the cycle needs it; invalid_value for a negative time.
/// Source: NISTIR 6556 (RS274/NGC v3), 3.5.16; behaves as LinuxCNC 2.9.
core::Result<void> check_rs274_cycle(const Execution& execution, const CannedCycle& cycle);

/// Exact path while a cycle runs, and what was there before it again.
void begin_exact_path(Execution& execution);
void end_exact_path(Execution& execution);

/// G84 and G74: down in a feed, the spindle reversed, P waited for, and out in a feed, overrides
/// off.
void tap_with_reversal(Drilling& hole);

/// G87: down off the middle, up to K in a feed, back, and out off the middle.
void bore_back_to_middle(Drilling& hole);

/// G88: the spindle and the program stop at the bottom. The control does not come out by itself,
/// and takes the tool as being outside again.
void bore_and_stop(Drilling& hole);

/// Lets the words a cycle keeps count in other units: LinuxCNC keeps the numbers.
void keep_numbers(CannedCycle& cycle, LengthUnit from, LengthUnit to);

} // namespace gcode

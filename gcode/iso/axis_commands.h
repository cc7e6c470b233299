#pragma once

#include "gcode/exec/execution.h"

namespace gcode {

/// Whether the control allows only one axis command in a block.
bool has_axis_commands(const Execution& execution);

/// Reports what is wrong with the axis commands of a block, of which the control runs no word then:
/// two of them, axis words that are missing or do not belong to them, or axis words after G80.
///
/// Source: Grbl 1.1, gcode.c, gc_execute_line, steps 2 and 3.
core::Result<void> check_axis_commands(Execution& execution);

/// Reports an arc without an end in its plane.
///
/// Source: as above.
core::Result<void> check_end_of_arc(const Execution& execution);

} // namespace gcode

#pragma once

#include "gcode/exec/execution.h"

namespace gcode {

/// The same result, with a place where its error has none.
template <typename T>
core::Result<T> placed(core::Result<T> result, core::SourceSpan where) {
    if (!result && result.error().where.line == 0) result.error().where = where;
    return result;
}

/// G5 and G5.1: curves of X and Y, as straight feeds within 0.001 mm of them.
core::Result<void> follow_spline(Execution& execution);

/// G5.2: another control point of a curve.
core::Result<void> gather_control_point(Execution& execution);

/// G5.3: along the curve, as straight feeds within 0.001 mm of it. Afterwards no motion is active.
core::Result<void> finish_spline(Execution& execution);

/// LinuxCNC's G76: a thread in passes.
///
/// Errors: those of threading_moves; syntax for rotary axes and cutter radius compensation;
///         missing_value for a spindle that stands still and for a start that is not known.
core::Result<void> cut_thread(Execution& execution);

/// LinuxCNC's G70, G71 and G72: along a contour that a subprogram describes, Q its number.
///
/// Errors: those of finishing_moves and roughing_moves, and those of the subprogram's blocks.
core::Result<void> turn_contour(Execution& execution);

} // namespace gcode

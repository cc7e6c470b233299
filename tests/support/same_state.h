#pragma once

#include <tuple>

#include "gcode/contour/contour.h"
#include "gcode/contour/spline.h"
#include "gcode/exec/interpreter.h"

namespace gcode {

/// Whether a program continues identically from two contours. What an idle contour holds is set
/// again when compensation begins.
inline bool continue_alike(const Contour& a, const Contour& b) {
    return (a.is_idle() && b.is_idle()) || a == b;
}

/// Whether a program continues identically from two states: everything is equal except the data of
/// the rules and of the search for endless loops.
inline bool continue_alike(const InterpreterState& a, const InterpreterState& b) {
    const auto deciding = [](const InterpreterState& state) {
        return std::tie(state.modal, state.next, state.next_block, state.tape_open, state.said_unit,
                        state.said_home, state.said_time, state.points, state.ending,
                        state.after_end, state.frames, state.modal_macros, state.said,
                        state.parameters, state.tables, state.spline, state.language,
                        state.is_iso_mode);
    };
    return deciding(a) == deciding(b) && continue_alike(*a.contour, *b.contour);
}

} // namespace gcode

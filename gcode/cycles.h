#pragma once

#include <cmath>

#include "gcode/execution.h"

namespace gcode {

/// A cycle with its levels along the drilling axis, program coordinates.
struct Drilling {
    Execution& execution;
    CannedCycle cycle;
    size_t first, second, normal;
    double r, bottom;
    std::optional<double> clear; // where it retracts to
    double rate;

    void traverse(std::optional<double> level) {
        Position end = execution.modal().position;
        end[normal] = level;
        execution.traverse(end);
    }
    void feed(double level) {
        Position end = execution.modal().position;
        end[normal] = level;
        execution.feed(end, rate);
    }
    void dwell() {
        if (cycle.dwell) execution.emit(Dwell{*cycle.dwell});
    }
    void turn(core::SpindleDirection direction) {
        const bool stopped = direction == core::SpindleDirection::stopped;
        execution.emit(Spindle{direction, stopped ? 0.0 : execution.modal().speed});
    }
};

/// G84, and G74 for left-hand threads: down to the bottom and back to R in feeds, the spindle
/// reversed between them; with Q in steps, out to R after each.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Rigid tapping" and "Peck rigid tapping cycle".
void tap(Drilling& hole);

/// G76: the tool leaves the wall at the bottom, before it comes out.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Fine boring cycle (G76)".
void bore_finely(Drilling& hole);

/// G87, Haas's G77: through the hole off its middle, up from R to Z in a feed, out off the middle.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Back boring cycle (G87)".
void bore_from_the_back(Drilling& hole);

/// G88, Haas's G87: the spindle stops at the bottom and the operator retracts.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Boring cycle (G88)".
void bore_and_retract_by_hand(Drilling& hole);

/// Whether a cycle works upwards, so that R lies below Z.
bool works_from_the_back(const Dialect& dialect, int code);

} // namespace gcode

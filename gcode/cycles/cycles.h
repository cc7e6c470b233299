#pragma once

#include <cmath>

#include "gcode/exec/execution.h"

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
    void feed(std::optional<double> level) {
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

/// Boring in which the tool is shifted or the operator retracts. G76: it leaves the wall at the
/// bottom, before it comes out. G87, on Haas G77: through the hole off its middle, up from R to Z
/// in a feed, out off the middle. G88, on Haas G87 too: the spindle stops, the operator retracts.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Fine boring cycle (G76)", "Back boring cycle
///         (G87)", "Boring cycle (G88)"; Haas mill operator's manual 96-8000, G77, G87, G88.
void bore(Drilling& hole);

/// G70, G71 or G72 of a block, Haas's patterns of holes; null without.
const CodeWord* hole_pattern(const Execution& execution);

/// Where a pattern's holes are: on a circle (G70), on an arc (G71), on a line from the start (G72).
///
/// Source: Haas mill operator's manual 96-8000, "Bolt hole patterns".
core::Result<std::vector<Position>> holes_of_pattern(const Execution& execution,
                                                     const CodeWord& entry, const Position& start);

/// Drills a pattern with the cycle that is active; one in the same block does it by itself.
core::Result<void> run_hole_pattern(Execution& execution);

/// Whether a cycle works upwards, so that R lies below Z.
bool works_from_the_back(const Dialect& dialect, int code);

} // namespace gcode

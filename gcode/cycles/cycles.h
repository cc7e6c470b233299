#pragma once

#include <cmath>

#include "gcode/exec/execution.h"

namespace gcode {

/// The result; an error without a position gets the given position in the program.
template <typename T>
core::Result<T> placed(core::Result<T> result, core::SourceSpan where) {
    if (!result && result.error().where.line == 0) result.error().where = where;
    return result;
}

struct Drilling;

/// What the words of a drilling cycle mean, and what it does.
struct CycleTraits {
    bool pecks = false; // needs Q, on Haas I, J and K instead
    bool taps = false;  // needs no Q, but pecks with one
    bool is_left_hand = false;
    bool shifts = false;        // off centre, by I, J and K
    bool works_upwards = false; // from R, which is below Z
    bool needs_dwell = false;   // P, where cycles are those of RS274/NGC
    bool stops_spindle = false; // which must turn before, where cycles are those of RS274/NGC
};

/// A row of the table of drilling cycles.
struct DrillingCycle {
    CodeNumber code;
    CycleTraits traits;
    void (*machine)(Drilling& hole);     // the motions at a hole; the tool is over it, or at R
    bool Dialect::*only_where = nullptr; // a later row is for the other dialects
};

/// The row of a canned cycle of a dialect other than G80 and the threading cycle G76 of LinuxCNC.
const DrillingCycle& drilling_cycle(CodeNumber code, const Dialect& dialect);

/// A drilling cycle with its levels along the drilling axis, in program coordinates.
struct Drilling {
    Execution& execution;
    const DrillingCycle& kind;
    CannedCycle cycle;
    size_t first, second, normal;
    double r, bottom;
    std::optional<double> clear; // retract level
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

/// G84, and G74 for left-hand threads: feed to the bottom and back to R, with the spindle reversed
/// in between; with Q in pecks, out to R after each.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Rigid tapping" and "Peck rigid tapping cycle".
void tap(Drilling& hole);

/// G85 and G89 retract at feed, on some controls only up to R. G89 dwells before.
void bore_and_feed_out(Drilling& hole);
void bore_dwell_and_feed_out(Drilling& hole);

/// G86: retracts with the spindle stopped.
void bore_with_stop(Drilling& hole);

/// G76: moves off the wall at the bottom before it retracts.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Fine boring cycle (G76)".
void bore_finely(Drilling& hole);

/// G87, on Haas G77: goes off centre through the hole, feeds up from R to Z and retracts off
/// centre.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Back boring cycle (G87)"; Haas mill operator's
///         manual 96-8000, G77.
void bore_from_the_back(Drilling& hole);

/// G88, on Haas also G87: the spindle stops at the bottom and the operator retracts.
///
/// Source: Fanuc 30i user's manual B-63944EN-2, "Boring cycle (G88)"; Haas mill operator's manual
///         96-8000, G87, G88.
void bore_and_retract_by_hand(Drilling& hole);

/// The G70, G71 or G72 of a block, a hole pattern of Haas; null if it has none.
const CodeWord* hole_pattern(const Execution& execution);

/// The holes of a pattern: on a circle (G70), on an arc (G71), on a line from the start (G72).
///
/// Source: Haas mill operator's manual 96-8000, "Bolt hole patterns".
core::Result<std::vector<Position>> holes_of_pattern(const Execution& execution,
                                                     const CodeWord& entry, const Position& start);

/// Drills a pattern with the active cycle. A cycle in the same block drills the pattern itself.
core::Result<void> run_hole_pattern(Execution& execution);

/// A cycle of the table of drilling cycles, at the holes of a block.
core::Result<void> run_canned_cycle(Execution& execution);

/// G12, G13: the tool plunges at the centre, moves out by a half circle, cuts a full circle, and
/// returns to the centre, where it stays. With K and Q more circles follow, each larger by Q. The
/// start angle on the control is not published and does not affect the material removed.
///
/// Source: Haas mill operator's manual, G12 and G13; D, I, K, L, Q.
core::Result<void> mill_circular_pocket(Execution& execution);

/// G174 and G184: rigid tapping from the current position straight to the end and back, in any
/// direction, left-hand (G174) or right-hand. The control starts the spindle.
///
/// Source: Haas mill operator's manual 96-8000, G174 and G184.
core::Result<void> tap_to_point(Execution& execution);

/// G5 and G5.1: curves in X and Y, as straight feed moves within 0.001 mm of them.
core::Result<void> follow_spline(Execution& execution);

/// G5.2: adds a control point to a curve.
core::Result<void> gather_control_point(Execution& execution);

/// G5.3: follows the curve by straight feed moves within 0.001 mm of it. Then no motion code is
/// active.
core::Result<void> finish_spline(Execution& execution);

/// G76 of LinuxCNC: a thread in several passes.
///
/// Errors: those of threading_moves; syntax for rotary axes and cutter radius compensation;
///         missing_value for a stopped spindle and for an unknown start.
core::Result<void> cut_thread(Execution& execution);

/// G70, G71 and G72 of LinuxCNC: turns a contour that is described by a subprogram, with number Q.
///
/// Errors: those of finishing_moves and roughing_moves, and those of the subprogram's blocks.
core::Result<void> turn_contour(Execution& execution);

} // namespace gcode

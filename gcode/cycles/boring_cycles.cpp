#include <fmt/format.h>

#include "gcode/cycles/cycles.h"

namespace gcode {
namespace {

using core::SpindleDirection;

bool shifts_by_words(const CannedCycle& cycle) {
    return cycle.shift[0] != 0.0 || cycle.shift[1] != 0.0 || cycle.shift[2] != 0.0;
}

/// The shift off centre: I, J and K of the plane, else Q along its first axis.
std::array<double, 2> shift_of(const Drilling& hole) {
    const CannedCycle& cycle = hole.cycle;
    if (!shifts_by_words(cycle)) return {cycle.peck.value_or(0.0), 0.0};
    return {cycle.shift[hole.first], cycle.shift[hole.second]};
}

void warn_of_direction(Drilling& hole) {
    if (shifts_by_words(hole.cycle) || !hole.cycle.peck) return;
    hole.execution.warn(
        moving_word(hole.execution).span,
        fmt::format(
            "{}: a parameter of the control sets the direction of the shift Q; +{} is assumed",
            written(hole.cycle.code), axis_letters[hole.first]),
        Severity::note);
}

/// Shifts the tool off centre; with -1 back to the centre.
void shift(Drilling& hole, double sign) {
    const std::array<double, 2> by = shift_of(hole);
    Position end = hole.execution.modal().position;
    if (end[hole.first]) *end[hole.first] += sign * by[0];
    if (end[hole.second]) *end[hole.second] += sign * by[1];
    hole.execution.traverse(end);
}

/// Retracts at feed.
void feed_out(Drilling& hole, bool only_to_r) {
    hole.feed(only_to_r ? hole.r : hole.clear);
    if (hole.clear != hole.r && only_to_r) hole.traverse(hole.clear);
}

} // namespace

void bore_and_feed_out(Drilling& hole) {
    const Dialect& rules = hole.execution.dialect;
    hole.feed(hole.bottom);
    feed_out(hole, rules.boring_feeds_to_r || rules.cycles_are_rs274);
}

void bore_dwell_and_feed_out(Drilling& hole) {
    hole.feed(hole.bottom);
    hole.dwell();
    feed_out(hole, hole.execution.dialect.boring_feeds_to_r);
}

void bore_with_stop(Drilling& hole) {
    const ModalState& modal = hole.execution.modal();
    hole.feed(hole.bottom);
    hole.dwell();
    hole.execution.emit(Spindle{SpindleDirection::stopped, 0.0});
    hole.traverse(hole.clear);
    hole.execution.emit(Spindle{modal.spindle, modal.speed});
}

void bore_finely(Drilling& hole) {
    const SpindleDirection direction = hole.execution.modal().spindle;
    warn_of_direction(hole);
    hole.feed(hole.bottom);
    hole.dwell();
    hole.turn(SpindleDirection::stopped);
    shift(hole, +1.0);
    hole.traverse(hole.clear);
    shift(hole, -1.0);
    hole.turn(direction);
}

void bore_from_the_back(Drilling& hole) {
    const SpindleDirection direction = hole.execution.modal().spindle;
    warn_of_direction(hole);
    hole.turn(SpindleDirection::stopped);
    shift(hole, +1.0);
    hole.traverse(hole.r);
    shift(hole, -1.0);
    hole.turn(direction);
    hole.feed(hole.bottom);
    hole.dwell();
    hole.turn(SpindleDirection::stopped);
    shift(hole, +1.0);
    hole.traverse(hole.cycle.initial_level);
    shift(hole, -1.0);
    hole.turn(direction);
}

void bore_and_retract_by_hand(Drilling& hole) {
    const SpindleDirection direction = hole.execution.modal().spindle;
    hole.feed(hole.bottom);
    hole.dwell();
    hole.turn(SpindleDirection::stopped);
    hole.execution.emit(ProgramStop{});
    hole.traverse(hole.clear);
    hole.turn(direction);
}

namespace {

/// Feeds down to a level and out to R, with the spindle reversed at the level.
void thread_to(Drilling& hole, double level, SpindleDirection in, SpindleDirection out) {
    hole.feed(level);
    if (level == hole.bottom) hole.dwell();
    hole.turn(out);
    hole.feed(hole.r);
    hole.turn(in);
}

} // namespace

void tap(Drilling& hole) {
    const bool left = hole.kind.traits.is_left_hand;
    const SpindleDirection in =
        left ? SpindleDirection::counterclockwise : SpindleDirection::clockwise;
    const SpindleDirection out =
        left ? SpindleDirection::clockwise : SpindleDirection::counterclockwise;
    const SpindleDirection before = hole.execution.modal().spindle;
    if (before != in) hole.turn(in);
    if (const std::optional<double> step = hole.cycle.peck)
        for (double level = hole.r - *step; level > hole.bottom; level -= *step)
            thread_to(hole, level, in, out);
    thread_to(hole, hole.bottom, in, out);
    if (before != in) hole.turn(before);
    if (hole.clear != hole.r) hole.traverse(hole.clear);
}

} // namespace gcode

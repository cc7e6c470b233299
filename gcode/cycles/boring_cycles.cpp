#include <fmt/format.h>

#include "gcode/cycles/cycles.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"

namespace gcode {
namespace {

using core::SpindleDirection;

bool shifts_by_words(const CannedCycle& cycle) {
    return cycle.shift[0] != 0.0 || cycle.shift[1] != 0.0 || cycle.shift[2] != 0.0;
}

bool has_shift_parameter(const Drilling& hole) {
    return find_parameter(ControlQuestion::shift_direction, hole.execution.environment.dialect);
}

/// The shift off centre: I, J and K of the plane, else Q in the direction that a parameter states.
std::array<double, 2> shift_of(const Drilling& hole) {
    const CannedCycle& cycle = hole.cycle;
    if (shifts_by_words(cycle)) return {cycle.shift[hole.first], cycle.shift[hole.second]};
    const double by = cycle.peck.value_or(0.0);
    if (by == 0.0 || !has_shift_parameter(hole)) return {by, 0.0};
    Execution& execution = hole.execution;
    const double direction = number_for(execution.state, execution.environment,
                                        ControlQuestion::shift_direction, execution.block.line);
    const double signed_by = direction < 0.0 ? -by : by;
    if (std::abs(direction) == 2.0) return {0.0, signed_by};
    return {signed_by, 0.0};
}

void warn_of_direction(Drilling& hole) {
    if (shifts_by_words(hole.cycle) || !hole.cycle.peck) return;
    const ControlSettings& control = hole.execution.environment.control;
    const bool is_known =
        control.reports_premises || control.number(ControlQuestion::shift_direction);
    if (is_known && has_shift_parameter(hole)) return;
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

core::Result<void> tap_to_point(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    const auto refuse = [&](std::string_view why) {
        return core::fail(core::ErrorCode::missing_value,
                          fmt::format("{} {}", written(*entry.word), why), entry.word->span);
    };
    if (!execution.statement.has_axis_word()) return refuse("needs X, Y or Z, the end of the hole");
    ModalState& modal = execution.modal();
    if (modal.speed == 0.0) return refuse("needs S, the speed of the spindle");
    const Position start = modal.position;
    FEELER_TRY(const Position end, target_of(execution));
    FEELER_TRY(const double rate, feed_rate(execution, distance_between(start, end)));
    const bool left = entry.code->number == g_code(174);
    const SpindleDirection clockwise = SpindleDirection::clockwise,
                           reverse = SpindleDirection::counterclockwise;
    execution.result.is_cycle = true;
    execution.emit(Spindle{left ? reverse : clockwise, modal.speed});
    execution.feed(end, rate);
    execution.emit(Spindle{left ? clockwise : reverse, modal.speed});
    execution.feed(start, rate);
    const bool stopped = modal.spindle == SpindleDirection::stopped;
    execution.emit(Spindle{modal.spindle, stopped ? 0.0 : modal.speed});
    return {};
}

} // namespace gcode

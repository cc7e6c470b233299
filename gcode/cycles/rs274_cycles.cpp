#include "gcode/cycles/rs274_cycles.h"

#include <fmt/format.h>

namespace gcode {
namespace {

using core::ErrorCode;
using core::SpindleDirection;

std::string_view name_of_start(SpindleDirection direction) {
    return direction == SpindleDirection::counterclockwise ? "M4" : "M3";
}

core::Result<void> check_axes(const Execution& execution, CodeNumber code) {
    const PlaneAxes plane = axes_of(execution.modal().plane);
    if (!execution.statement.has_axis_word())
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{} has no axis word: add the position of the hole", written(code)),
            moving_word(execution).span);
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word || axis == plane.first || axis == plane.second || axis == plane.normal) continue;
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{}: a cycle moves only {}, {} and {}: move {} in an earlier block",
                        written(*word), axis_letters[plane.first], axis_letters[plane.second],
                        axis_letters[plane.normal], word->letter),
            word->span);
    }
    return {};
}

core::Result<void> check_dwell(const Execution& execution, const DrillingCycle& kind,
                               const CannedCycle& cycle) {
    if (kind.traits.needs_dwell && !cycle.dwell)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{} needs a P word, the dwell at the bottom in seconds",
                                      written(cycle.code)),
                          moving_word(execution).span);
    return {};
}

/// G87 needs all three words once; they are modal in the following blocks.
core::Result<void> check_shift(const Execution& execution, const DrillingCycle& kind) {
    const bool is_first = !execution.modal().cycle->bottom;
    if (!kind.traits.shifts || !is_first) return {};
    for (const char letter : {'I', 'J', 'K'})
        if (!execution.statement.word(letter))
            return core::fail(ErrorCode::missing_value,
                              fmt::format("{} has no {}: it needs I and J, the shift off centre, "
                                          "and K, where the boring ends",
                                          written(kind.code), letter),
                              moving_word(execution).span);
    return {};
}

core::Result<void> check_spindle(const Execution& execution, const DrillingCycle& kind) {
    const bool taps = kind.traits.taps, left = kind.traits.is_left_hand;
    const SpindleDirection direction = execution.modal().spindle;
    if (taps && axes_of(execution.modal().plane).normal > 2)
        return core::fail(
            ErrorCode::unsupported,
            fmt::format("{}: the control taps along X, Y and Z only, not in this plane: use G17",
                        written(kind.code)),
            moving_word(execution).span);
    const core::SourceSpan where = moving_word(execution).span;
    if ((taps || kind.traits.stops_spindle) && direction == SpindleDirection::stopped)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{}: the spindle is stopped: start it with {} first",
                                      written(kind.code), left ? "M4" : "M3"),
                          where);
    const SpindleDirection needed =
        left ? SpindleDirection::counterclockwise : SpindleDirection::clockwise;
    if (taps && direction != needed)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format(
                "{} cuts a {} thread, but the spindle turns the other way: start it with {} first",
                written(kind.code), left ? "left-hand" : "right-hand", name_of_start(needed)),
            where);
    return {};
}

/// Shifts the tool off centre; I, J and K belong to the axes of the plane.
void shift_off_middle(Drilling& hole, double sign) {
    Position end = hole.execution.modal().position;
    for (const size_t axis : {hole.first, hole.second})
        if (end[axis]) *end[axis] += sign * hole.cycle.shift[axis % 3];
    hole.execution.traverse(end);
}

/// A feed move of a tap. LinuxCNC 2.9 swaps the axes in G18 and G19, so the tool leaves its hole,
/// and continues as if it had not.
void feed_tapping(Drilling& hole, std::optional<double> level) {
    Position& position = hole.execution.modal().position;
    position[hole.normal] = level;
    Position end = position;
    if (hole.execution.modal().plane == Plane::zx) {
        end[0] = level, end[1] = position[hole.first], end[2] = position[hole.second];
    } else if (hole.execution.modal().plane == Plane::yz) {
        end[0] = position[hole.second], end[1] = level, end[2] = position[hole.first];
    }
    hole.execution.emit(StraightFeed{end, hole.rate});
}

void warn_of_plane(Drilling& hole) {
    if (hole.execution.modal().plane == Plane::xy) return;
    hole.execution.warn(moving_word(hole.execution).span,
                        fmt::format("{} outside G17 moves the tool off the hole: LinuxCNC 2.9 "
                                    "swaps the axes of the feed moves; tap in G17, or with G33.1",
                                    written(hole.cycle.code)));
}

void enable_overrides(Execution& execution, bool enabled) {
    // They are also switched off after M49; G76 then leaves the feed override on.
    if (!enabled || execution.modal().feed_override)
        execution.emit(EnableOverride{OverrideKind::feed, enabled});
    if (!enabled || execution.modal().speed_override)
        execution.emit(EnableOverride{OverrideKind::speed, enabled});
}

} // namespace

core::Result<void> check_rs274_cycle(const Execution& execution, const DrillingCycle& kind,
                                     const CannedCycle& cycle) {
    if (execution.modal().compensation != Side::none)
        return core::fail(ErrorCode::syntax,
                          fmt::format("{}: no cycle is allowed while cutter radius compensation "
                                      "is on: cancel it with G40 first",
                                      written(cycle.code)),
                          moving_word(execution).span);
    if (auto checked = check_axes(execution, cycle.code); !checked) return checked;
    if (auto checked = check_dwell(execution, kind, cycle); !checked) return checked;
    if (auto checked = check_shift(execution, kind); !checked) return checked;
    return check_spindle(execution, kind);
}

void begin_exact_path(Execution& execution) {
    if (execution.modal().path != PathMode::exact_path)
        execution.emit(SetPathMode{PathMode::exact_path, 0.0, 0.0});
}

void end_exact_path(Execution& execution) {
    const ModalState& modal = execution.modal();
    if (modal.path != PathMode::exact_path) execution.emit(path_mode_of(modal));
}

void tap_with_reversal(Drilling& hole) {
    Execution& execution = hole.execution;
    const SpindleDirection in = execution.modal().spindle;
    const SpindleDirection out = in == SpindleDirection::clockwise
                                     ? SpindleDirection::counterclockwise
                                     : SpindleDirection::clockwise;
    warn_of_plane(hole);
    enable_overrides(execution, false);
    feed_tapping(hole, hole.bottom);
    hole.turn(SpindleDirection::stopped);
    hole.turn(out);
    execution.emit(Dwell{hole.cycle.dwell.value_or(execution.modal().cycle_dwell)});
    feed_tapping(hole, hole.clear);
    hole.turn(SpindleDirection::stopped);
    hole.turn(in);
    enable_overrides(execution, true);
}

void bore_back_to_middle(Drilling& hole) {
    const SpindleDirection direction = hole.execution.modal().spindle;
    const double word = hole.cycle.shift[hole.normal % 3];
    const bool incremental = hole.execution.modal().distance == DistanceMode::incremental;
    shift_off_middle(hole, +1.0);
    hole.turn(SpindleDirection::stopped);
    hole.traverse(hole.bottom);
    shift_off_middle(hole, -1.0);
    hole.turn(direction);
    hole.feed(incremental ? hole.bottom + word : word);
    hole.feed(hole.bottom);
    hole.turn(SpindleDirection::stopped);
    shift_off_middle(hole, +1.0);
    hole.traverse(hole.clear);
    shift_off_middle(hole, -1.0);
    hole.turn(direction);
}

void bore_and_stop(Drilling& hole) {
    Execution& execution = hole.execution;
    const SpindleDirection direction = execution.modal().spindle;
    hole.feed(hole.bottom);
    hole.dwell();
    hole.turn(SpindleDirection::stopped);
    execution.emit(ProgramStop{});
    hole.turn(direction);
    execution.warn(moving_word(execution).span,
                   "G88 leaves the tool at the bottom of the hole: unless the operator retracts it "
                   "during the stop, the next move starts there");
    execution.modal().position[hole.normal] = hole.clear;
}

} // namespace gcode

#include "gcode/cycles/cycles.h"

#include <cmath>

#include <fmt/format.h>

#include "gcode/cycles/rs274_cycles.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// Haas: I is the first peck, each further one is shorter by J but not shorter than K.
///
/// Source: Haas mill operator's manual 96-8000, G73 and G83.
bool pecks_shrink(const DrillingCycle& kind, const CannedCycle& cycle) {
    return kind.traits.pecks && cycle.shift[0] > 0.0;
}

tl::unexpected<core::Error> missing(const Execution& execution, const CannedCycle& cycle,
                                    char letter) {
    return core::fail(ErrorCode::missing_value,
                      fmt::format("{} needs {} word", written(cycle.code),
                                  letter == 'R' ? "an R" : fmt::format("a {}", letter)),
                      moving_word(execution).span);
}

/// I, J or K of a cycle that shifts the tool; K may instead be the number of repetitions.
const Word* shift_word(const Execution& execution, const CycleTraits& traits, size_t axis) {
    if (hole_pattern(execution)) return nullptr;
    const bool shrinks = traits.pecks && execution.dialect.pecks_may_shrink;
    const bool repeats = axis == 2 && execution.dialect.repeats_with_k && !shrinks;
    if ((!shrinks && !traits.shifts) || repeats) return nullptr;
    return execution.statement.word("IJK"[axis]);
}

/// The axes of a cycle: those of the plane, or X, Y and Z.
PlaneAxes axes_of_cycle(Execution& execution) {
    const PlaneAxes axes = axes_of(execution.modal().plane);
    constexpr ControlQuestion question = ControlQuestion::drills_normal_to_plane;
    if (axes.normal == 2 || !find_parameter(question, execution.environment.dialect)) return axes;
    const bool follows =
        answer_to(execution.state, execution.environment, question, execution.block.line);
    return follows ? axes : axes_of(Plane::xy);
}

/// Whether the block only defines its cycle, on a control that then waits for X or Y.
bool only_defines(Execution& execution, const PlaneAxes& axes) {
    const Statement& statement = execution.statement;
    constexpr ControlQuestion question = ControlQuestion::drills_where_defined;
    if (!statement.of(ModalGroup::cycle) || hole_pattern(execution)
        || statement.word(axis_letters[axes.first]) || statement.word(axis_letters[axes.second])
        || !find_parameter(question, execution.environment.dialect))
        return false;
    return !answer_to(execution.state, execution.environment, question, execution.block.line);
}

/// R and the bottom. Values programmed with G90 stay absolute for holes in G91, except where a
/// control applies the current mode.
void take_levels(const Execution& execution, size_t normal, CannedCycle& cycle) {
    const bool incremental = execution.modal().distance == DistanceMode::incremental;
    if (const Word* word = execution.statement.word(axis_letters[normal])) {
        cycle.bottom = length_of(execution, *word);
        cycle.bottom_is_incremental = incremental;
    }
    if (const Word* word = execution.statement.word('R')) {
        cycle.r = length_of(execution, *word);
        cycle.r_is_incremental = incremental;
    }
    if (execution.dialect.cycle_levels_follow_g91)
        cycle.r_is_incremental = cycle.bottom_is_incremental = incremental;
}

/// The modal cycle updated with the words of this block.
core::Result<CannedCycle> cycle_with_words(const Execution& execution, const DrillingCycle& kind,
                                           size_t normal) {
    CannedCycle cycle = *execution.modal().cycle;
    const Statement& statement = execution.statement;
    take_levels(execution, normal, cycle);
    if (const Word* word = statement.word('Q')) {
        const double depth = length_of(execution, *word);
        cycle.peck = execution.dialect.peck_sign_is_ignored ? std::abs(depth) : depth;
        if (kind.traits.taps && depth == 0.0)
            cycle.peck.reset();
        else if (*cycle.peck <= 0.0)
            return core::fail(
                ErrorCode::invalid_value,
                fmt::format("{}: the peck depth must be greater than 0", written(*word)),
                word->span);
    }
    if (const Word* word = statement.word('P')) {
        FEELER_TRY(cycle.dwell, dwell_time(execution, *word));
    }
    for (size_t i = 0; i < 3; ++i)
        if (const Word* word = shift_word(execution, kind.traits, i))
            cycle.shift[i] = length_of(execution, *word);
    if (!cycle.bottom) return missing(execution, cycle, axis_letters[normal]);
    if (!cycle.r) return missing(execution, cycle, 'R');
    const bool shrinks = pecks_shrink(kind, cycle);
    if (kind.traits.pecks && !shrinks && !cycle.peck) return missing(execution, cycle, 'Q');
    if (shrinks && cycle.shift[2] <= 0.0) return missing(execution, cycle, 'K');
    if (!cycle.initial_level) cycle.initial_level = execution.modal().position[normal];
    if (execution.dialect.cycles_are_rs274)
        if (auto checked = check_rs274_cycle(execution, kind, cycle); !checked)
            return tl::unexpected(std::move(checked).error());
    return cycle;
}

/// Checks that the levels of the cycle fit together and that the cycle ends.
core::Result<void> check_levels(const Execution& execution, const DrillingCycle& kind,
                                const CannedCycle& cycle, double r, double bottom) {
    const core::SourceSpan where = moving_word(execution).span;
    const bool upwards = kind.traits.works_upwards;
    if (upwards && r > bottom)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{} works upwards from R to {}, but R at {:.4f} mm is above {:.4f} mm",
                        written(cycle.code), axis_letters[axes_of(execution.modal().plane).normal],
                        r, bottom),
            where);
    if (upwards && execution.modal().retract == RetractMode::r_level)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{} must return to the initial level: G99 would leave the "
                                      "tool below the work; use G98",
                                      written(cycle.code)),
                          where);
    if (!upwards && r < bottom)
        return core::fail(
            ErrorCode::invalid_value,
            fmt::format("{}: R at {:.4f} mm is below the bottom of the hole at {:.4f} mm",
                        written(cycle.code), r, bottom),
            where);
    const double least_peck =
        pecks_shrink(kind, cycle) ? cycle.shift[2] : cycle.peck.value_or(r - bottom);
    if (least_peck > 0.0 && (r - bottom) / least_peck > most_commands / 4)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: this Q gives more than {} pecks", written(cycle.code),
                                      most_commands / 4),
                          where);
    if (execution.modal().feed_mode == FeedMode::inverse_time)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: a cycle cannot run in inverse-time feed mode (G93)",
                                      written(cycle.code)),
                          where);
    return {};
}

/// A tap synchronised with the spindle may start with the spindle stopped.
core::Result<double> cycle_rate(const Execution& execution, const DrillingCycle& kind) {
    const ModalState& modal = execution.modal();
    const bool with_spindle =
        modal.feed_mode == FeedMode::per_turn && modal.feed && modal.speed > 0;
    if (kind.traits.taps && with_spindle && *modal.feed > 0.0) return *modal.feed * modal.speed;
    return feed_rate(execution, std::nullopt);
}

core::Result<Drilling> drilling_of(Execution& execution, const DrillingCycle& kind,
                                   const CannedCycle& cycle, const PlaneAxes& axes) {
    const ModalState& modal = execution.modal();
    const core::SourceSpan where = moving_word(execution).span;
    if (cycle.r_is_incremental && !cycle.initial_level)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{}: with G91 the cycle is relative to the current "
                                      "position, which is unknown in {}",
                                      written(cycle.code), axis_letters[axes.normal]),
                          where);
    const double r = cycle.r_is_incremental ? *cycle.initial_level + *cycle.r : *cycle.r;
    const double bottom = cycle.bottom_is_incremental ? r + *cycle.bottom : *cycle.bottom;
    if (auto checked = check_levels(execution, kind, cycle, r, bottom); !checked)
        return tl::unexpected(std::move(checked).error());
    std::optional<double> clear = cycle.initial_level;
    const bool too_low = execution.dialect.cycle_stays_above_r && clear && *clear < r;
    if (modal.retract == RetractMode::r_level || too_low) clear = r;
    FEELER_TRY(const double rate, cycle_rate(execution, kind));
    return Drilling{
        execution, kind, cycle, axes.first, axes.second, axes.normal, r, bottom, clear, rate,
    };
}

core::Result<int> repeats_of(const Execution& execution) {
    if (hole_pattern(execution)) return 1;
    const Word* word = execution.statement.word('L');
    if (!word && execution.dialect.repeats_with_k) word = execution.statement.word('K');
    if (!word) return 1;
    return whole_number(*word, execution.dialect.cycles_are_rs274 ? 1 : 0, 10000);
}

/// Moves to the next hole, also along the rotary and other axes that the block names, then down to
/// R.
void approach(Drilling& hole, const Position& target) {
    Execution& execution = hole.execution;
    Position over = execution.modal().position;
    // LinuxCNC goes to the next hole at its level if that is above R, otherwise at the initial one.
    const bool is_above = over[hole.normal] && *over[hole.normal] > hole.r;
    const bool climbs = execution.dialect.g98_cycle_starts_high && !is_above
                        && execution.modal().retract == RetractMode::initial_level;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (axis != hole.normal) over[axis] = target[axis];
    const bool only_climbs = execution.dialect.cycles_are_rs274 && over[hole.normal];
    const double lowest = only_climbs ? std::max(*over[hole.normal], hole.r) : 0.0;
    if (climbs && hole.clear) over[hole.normal] = hole.clear;
    if (only_climbs) over[hole.normal] = std::max(*over[hole.normal], lowest);
    execution.traverse(over);
    if (!hole.kind.traits.works_upwards && over[hole.normal] != hole.r) hole.traverse(hole.r);
}

/// Refuses a word of the axis parallel to the drilling axis: which of the two drills depends on the
/// control.
core::Result<void> check_parallel_axis(const Execution& execution, size_t normal) {
    const size_t parallel = normal + 6;
    if (parallel >= axis_count) return {};
    const Word* word = execution.statement.word(axis_letters[parallel]);
    if (!word) return {};
    return core::fail(ErrorCode::unsupported,
                      fmt::format("{}: whether {} or {} drills in this cycle depends on the "
                                  "control: move {} in an earlier block",
                                  written(*word), axis_letters[normal], word->letter, word->letter),
                      word->span);
}

/// Whether the block moves an axis besides those of the plane and the drilling axis.
bool moves_another_axis(const Execution& execution, size_t normal, const Position& target) {
    for (size_t axis = 3; axis < axis_count; ++axis)
        if (axis != normal && target[axis] != execution.modal().position[axis]) return true;
    return false;
}

/// The next of L holes with G91: the same step again, or the same polar words once more.
core::Result<Position> next_hole(Execution& execution, Position target, const Position& step) {
    if (auto taken = read_polar_words(execution); !taken) // of G16
        return tl::unexpected(std::move(taken).error());
    if (execution.statement.polar_radius || execution.statement.polar_angle
        || execution.modal().transforms.polar)
        return target_of(execution);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (target[axis] && step[axis]) *target[axis] += *step[axis];
    return target;
}

Position step_between(const Position& from, const Position& to) {
    Position step;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (from[axis] && to[axis]) step[axis] = *to[axis] - *from[axis];
    return step;
}

} // namespace

core::Result<void> run_canned_cycle(Execution& execution) {
    ModalState& modal = execution.modal();
    const PlaneAxes axes = axes_of_cycle(execution);
    const size_t normal = axes.normal;
    FEELER_TRY(Position target, target_of(execution));
    const DrillingCycle& kind = drilling_cycle(modal.cycle->code, execution.dialect);
    FEELER_TRY(const CannedCycle cycle, cycle_with_words(execution, kind, normal));
    FEELER_TRY(const int repeats, repeats_of(execution));
    modal.cycle = cycle;
    modal.cycle_dwell = cycle.dwell.value_or(modal.cycle_dwell);
    execution.result.is_cycle = true;
    if (auto checked = check_parallel_axis(execution, normal); !checked) return checked;
    if (repeats == 0 || only_defines(execution, axes)) {
        if (moves_another_axis(execution, normal, target))
            return core::fail(ErrorCode::unsupported,
                              fmt::format("{}: whether the control moves the axes of this block, "
                                          "which only defines its cycle, is not known: move them "
                                          "in an earlier block",
                                          written(cycle.code)),
                              moving_word(execution).span);
        return {};
    }
    FEELER_TRY(Drilling hole, drilling_of(execution, kind, cycle, axes));

    // RS274/NGC 3.5.16: from below R the axis first moves up to R. On other controls the move to
    // the hole is made at the current level.
    const bool rs274 = execution.dialect.cycles_are_rs274;
    const std::optional<double> level = rs274 ? cycle.initial_level : modal.position[normal];
    const bool is_low = level && *level < hole.r;
    if (is_low && execution.dialect.cycle_stays_above_r) hole.traverse(hole.r);
    if (rs274) begin_exact_path(execution);
    if (const CodeWord* pattern = hole_pattern(execution)) {
        FEELER_TRY(const std::vector<Position> holes,
                   holes_of_pattern(execution, *pattern, target));
        for (const Position& place : holes) {
            approach(hole, place);
            hole.kind.machine(hole);
        }
        return {};
    }
    const Position step = modal.distance == DistanceMode::incremental
                              ? step_between(modal.position, target)
                              : zero_position;
    for (int repeat = 0; repeat < repeats; ++repeat) {
        approach(hole, target);
        hole.kind.machine(hole);
        if (repeat + 1 < repeats) {
            FEELER_TRY(target, next_hole(execution, target, step));
        }
        if (execution.result.commands.size() > most_commands)
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("{}: this block gives more than {} moves",
                                          written(cycle.code), most_commands),
                              moving_word(execution).span);
    }
    if (rs274) end_exact_path(execution);
    return {};
}

namespace {

core::Result<double> needed(const Execution& execution, const CodeWord& entry, char letter,
                            bool is_length) {
    if (const Word* word = execution.statement.word(letter))
        return is_length ? length_of(execution, *word) : word->value;
    return core::fail(ErrorCode::missing_value,
                      fmt::format("{} needs {} word", written(*entry.word),
                                  letter == 'I' || letter == 'L' ? fmt::format("an {}", letter)
                                                                 : fmt::format("a {}", letter)),
                      entry.word->span);
}

/// The point at a distance and direction from another.
Position placed(const Position& from, const PlaneAxes& axes, double distance, double degrees) {
    const core::Mat3 turn = turned_about(2, degrees);
    Position place = from;
    if (place[axes.first]) *place[axes.first] += distance * turn[0][0];
    if (place[axes.second]) *place[axes.second] += distance * turn[0][1];
    return place;
}

} // namespace

const CodeWord* hole_pattern(const Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::action);
    const bool is_pattern =
        entry && entry->code->number >= g_code(70) && entry->code->number <= g_code(72);
    return is_pattern ? entry : nullptr;
}

core::Result<std::vector<Position>> holes_of_pattern(const Execution& execution,
                                                     const CodeWord& entry, const Position& start) {
    FEELER_TRY(const double length, needed(execution, entry, 'I', true));
    if (auto said = needed(execution, entry, 'L', false); !said)
        return tl::unexpected(std::move(said).error());
    FEELER_TRY(const int count, whole_number(*execution.statement.word('L'), 1, 1000));
    const Word* angle = execution.statement.word('J');
    const double first = angle ? angle->value : 0.0;
    const PlaneAxes axes = axes_of(execution.modal().plane);
    double step = 360.0 / count;
    if (entry.code->number == g_code(71)) {
        FEELER_TRY(step, needed(execution, entry, 'K', false));
    }
    std::vector<Position> holes;
    for (int i = 0; i < count; ++i)
        holes.push_back(entry.code->number == g_code(72)
                            ? placed(start, axes, i * length, first)
                            : placed(start, axes, length, first + i * step));
    return holes;
}

core::Result<void> run_hole_pattern(Execution& execution) {
    const CodeWord& entry = *hole_pattern(execution);
    if (execution.statement.of(ModalGroup::cycle)) return {}; // drilled by the cycle
    if (!execution.modal().cycle)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{}: no canned cycle to drill the holes with: program one, "
                                      "such as G81 with L0, first; cycles of lathes are not "
                                      "supported",
                                      written(*entry.word)),
                          entry.word->span);
    return run_canned_cycle(execution);
}

} // namespace gcode

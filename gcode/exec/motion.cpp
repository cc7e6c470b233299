#include "gcode/exec/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/units.h"
#include "gcode/cycles/spline.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/frame_codes.h"

namespace gcode {
namespace {

using core::ErrorCode;

bool in_machine_coordinates(const Execution& execution) {
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    return action && action->code->tenths == tenths(53);
}

bool is_straight(std::optional<MotionCode> motion) {
    return motion == tenths(0) || motion == tenths(1);
}

bool is_arc(std::optional<MotionCode> motion) { return motion == tenths(2) || motion == tenths(3); }

/// Whether the words of the plane are a radius and an angle (G16).
bool moves_by_radius_and_angle(const Execution& execution) {
    const ModalState& modal = execution.modal();
    if (!modal.transforms.polar || execution.statement.taker_of_axis_words()) return false;
    const PlaneAxes axes = axes_of(modal.plane);
    return !in_machine_coordinates(execution)
           && (execution.statement.word(axis_letters[axes.first])
               || execution.statement.word(axis_letters[axes.second]));
}

/// Where a control goes on with a feed of its own, the first feed without F takes that.
void assume_feed(Execution& execution) {
    ModalState& modal = execution.modal();
    const double assumed = execution.dialect.assumed_feed;
    if (modal.feed || assumed == 0.0 || modal.feed_mode != FeedMode::per_minute) return;
    const Word& mover = moving_word(execution);
    execution.result.warnings.push_back(
        {Severity::warning, mover.span,
         fmt::format("{}: no feed rate: no F word has been programmed yet; Grbl 1.1 stops here "
                     "(error 22), older versions use {:g} mm/min, which is assumed",
                     written(mover), assumed),
         "no-feed", "Program F before the first feed move."});
    modal.feed = assumed;
}

core::Result<void> move_straight(Execution& execution, bool rapid) {
    if (!rapid) assume_feed(execution);
    FEELER_TRY(const Position end, target_of(execution));
    if (rapid) {
        execution.traverse(end);
        return {};
    }
    const bool needs_way = execution.modal().feed_mode == FeedMode::inverse_time;
    const std::optional<double> way =
        needs_way ? way_between(execution.modal().position, end) : std::nullopt;
    FEELER_TRY(const double rate, feed_rate(execution, way));
    execution.feed(end, rate);
    return {};
}

/// A motion code without a place to go to, where that is a move to where the machine stands.
bool stands_alone(const Execution& execution) {
    const CodeWord* motion = execution.statement.of(ModalGroup::motion);
    return execution.dialect.motion_codes_move && motion
           && (is_straight(motion->code->tenths) || is_arc(motion->code->tenths));
}

/// G2 alone, of which nobody knows where it leads.
core::Result<void> refuse_lone_arc(const Execution& execution) {
    const Statement& statement = execution.statement;
    const CodeWord* motion = statement.of(ModalGroup::motion);
    if (!execution.dialect.motion_codes_move || !motion || !is_arc(motion->code->tenths)) return {};
    for (const char letter : {'I', 'J', 'K', 'R'})
        if (statement.word(letter)) return {};
    return core::fail(ErrorCode::missing_value,
                      fmt::format("{} has no centre: add I, J or K, or the radius as R; if no arc "
                                  "is intended here, remove the code",
                                  written(*motion->word)),
                      motion->word->span);
}

/// Whether the block has words that make the active motion move.
bool has_motion_words(const Execution& execution) {
    const Statement& statement = execution.statement;
    if (!statement.has_axis_word() && stands_alone(execution)) return true;
    if (statement.taker_of_axis_words()) return false;
    if (statement.has_axis_word()) return true;
    if (statement.of(ModalGroup::motion) && execution.dialect.motion_codes_move) return true;
    const ModalState& modal = execution.modal();
    const bool arc = !modal.cycle && is_arc(modal.motion);
    return arc && (statement.word('I') || statement.word('J') || statement.word('K'));
}

/// Whether a motion code is for its block only: G5, G5.1, G5.3, G70 to G72.
bool acts_once(int code) {
    return code == tenths(5) || code == tenths(5, 1) || code == tenths(5, 3)
           || (code >= tenths(70) && code < tenths(73));
}

/// Begins with a motion code, or goes on with none.
void set_motion(InterpreterState& state, std::optional<MotionCode> motion) {
    std::optional<MotionCode>& active = state.modal.motion;
    if (active == tenths(5, 2) && motion != active) state.spline.write().gathering = {};
    active = motion;
}

/// Another cycle begins with words of its own, but counts from the same level.
void forget_words(CannedCycle& cycle) {
    CannedCycle fresh;
    fresh.initial_level = cycle.initial_level;
    cycle = fresh;
}

/// Codes that other ones may not share a block with, even without axis words.
bool wants_axes_alone(const CodeWord& taker) {
    constexpr int codes[] = {tenths(10), tenths(28), tenths(30), tenths(52), tenths(92)};
    return std::find(std::begin(codes), std::end(codes), taker.code->tenths) != std::end(codes);
}

/// G0 to G3 and the cycles become modal, even when another code takes the axis words.
core::Result<void> set_motion_mode(Execution& execution) {
    const Statement& statement = execution.statement;
    ModalState& modal = execution.modal();
    const CodeWord* taker = statement.taker_of_axis_words();
    const CodeWord* cycle = statement.of(ModalGroup::cycle);
    const CodeWord* motion = statement.of(ModalGroup::motion);
    const CodeWord* mover = cycle && cycle->code->uses_axes() ? cycle : motion;
    const bool homes = taker && taker->code->tenths != tenths(4)
                       && (statement.has_axis_word() || wants_axes_alone(*taker));
    if (mover && homes && execution.dialect.axis_words_serve_one_code)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{} and {} both use the axis words of this block: split it into two blocks",
                        written(*taker->word), written(*mover->word)),
            mover->word->span);
    if (motion && !acts_once(motion->code->tenths)) {
        set_motion(execution.state, motion->code->tenths);
        modal.cycle.reset();
    }
    if (!cycle) return {};
    if (execution.dialect.cycles_are_motions && !motion) set_motion(execution.state, {});
    if (cycle->code->tenths == tenths(80)) {
        modal.cycle.reset();
        return {};
    }
    const int code = cycle->code->tenths;
    if (!modal.cycle)
        modal.cycle = CannedCycle{};
    else if (execution.dialect.cycles_are_rs274 && modal.cycle->code != code)
        forget_words(*modal.cycle);
    else if (modal.cycle->code != code)
        modal.cycle->shift = {};
    modal.cycle->code = cycle->code->tenths;
    return {};
}

/// Before the first motion code: the one that the control begins with.
core::Result<void> move_without_mode(Execution& execution) {
    for (const Word& word : execution.block.words) {
        if (axis_letters.find(word.letter) == std::string_view::npos) continue;
        if (!execution.dialect.begins_with_g0)
            return core::fail(ErrorCode::missing_value,
                              fmt::format("{}: no motion code is active; program G0, G1, G2 or G3",
                                          written(word)),
                              word.span);
        execution.warn(
            word.span,
            fmt::format(
                "{}: no motion code is active; G0, the power-on default of the control, is assumed",
                written(word)));
        execution.modal().motion = tenths(0);
        return move_straight(execution, true);
    }
    return {};
}

/// RS274/NGC 3.5.14: G53 is for this block, and goes with G0 and G1 only. On Fanuc controls it is a
/// rapid whatever the motion code, and under G91 it is passed over.
core::Result<void> move_to_machine_place(Execution& execution) {
    ModalState& modal = execution.modal();
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    const bool incremental = modal.distance == DistanceMode::incremental;
    if (execution.dialect.machine_move_needs_g90 && incremental)
        return core::fail(ErrorCode::unsupported,
                          "G53 with G91 stops some controls and is ignored by others: use G90",
                          action->word->span);
    if (execution.dialect.machine_move_is_rapid) return move_straight(execution, true);
    if (modal.cycle || !is_straight(modal.motion))
        return core::fail(ErrorCode::syntax, "G53 needs G0 or G1", action->word->span);
    return move_straight(execution, modal.motion == tenths(0));
}

/// G53 in a block that does not move.
core::Result<void> refuse_lone_machine_place(const Execution& execution) {
    if (!execution.dialect.machine_move_needs_motion || !in_machine_coordinates(execution))
        return {};
    return core::fail(ErrorCode::missing_value,
                      "G53 applies to its own block only, and this block has no move: add G0 or G1 "
                      "and a position",
                      execution.statement.of(ModalGroup::action)->word->span);
}

core::Result<void> act_once(Execution& execution, int code) {
    if (code >= tenths(70)) return turn_contour(execution);
    return code == tenths(5, 3) ? finish_spline(execution) : follow_spline(execution);
}

core::Result<void> move_as_modes_say(Execution& execution) {
    const ModalState& modal = execution.modal();
    const CodeWord* motion = execution.statement.of(ModalGroup::motion);
    if (motion && acts_once(motion->code->tenths)) return act_once(execution, motion->code->tenths);
    const bool threads = modal.cycle && modal.cycle->code == tenths(76);
    if (threads && execution.dialect.cycles_are_rs274) return cut_thread(execution);
    if (modal.cycle) return run_canned_cycle(execution);
    if (!modal.motion) return move_without_mode(execution);
    if (is_straight(modal.motion)) return move_straight(execution, modal.motion == tenths(0));
    if (is_arc(modal.motion)) {
        assume_feed(execution);
        return move_along_arc(execution);
    }
    if (modal.motion == tenths(5, 2)) return gather_control_point(execution);
    return modal.motion < tenths(38) ? feed_with_spindle(execution) : probe(execution);
}

} // namespace

void Execution::traverse(const Position& end) {
    modal().position = end;
    modal().leaves_contour = false;
    emit(StraightTraverse{end});
}

void Execution::feed(const Position& end, double rate) {
    modal().position = end;
    modal().leaves_contour = false;
    emit(StraightFeed{end, rate});
}

const Word& moving_word(const Execution& execution) {
    const Statement& statement = execution.statement;
    for (const ModalGroup group : {ModalGroup::cycle, ModalGroup::motion})
        if (const CodeWord* entry = statement.of(group)) return *entry->word;
    for (const Word& word : execution.block.words)
        if (std::string_view("XYZABCUVWIJK@^").find(word.letter) != std::string_view::npos)
            return word;
    return execution.block.words.front();
}

double axis_value(const Execution& execution, size_t axis, const Word& word) {
    if (is_rotary(axis)) return word.value;
    const double length = length_of(execution, word);
    return axis == 0 && execution.modal().diameter_mode ? length / 2.0 : length;
}

namespace {

/// G53 with @ or ^, which are about the origin of the program.
core::Result<void> refuse_polar_words(const Execution& execution) {
    const Statement& statement = execution.statement;
    const Word* word = statement.polar_radius ? statement.polar_radius : statement.polar_angle;
    if (!word) return {};
    return core::fail(ErrorCode::syntax,
                      fmt::format("{}: @ and ^ are relative to the program origin and cannot be "
                                  "used with G53: use X and Y",
                                  written(*word)),
                      word->span);
}

/// @ and ^: X and Y by their distance from the origin and the angle there, in every plane. What is
/// not said is that of the present place.
core::Result<void> place_polar(const Execution& execution, Position& target) {
    const Statement& statement = execution.statement;
    const Word& first = statement.polar_radius ? *statement.polar_radius : *statement.polar_angle;
    for (const char letter : {'X', 'Y'})
        if (const Word* word = statement.word(letter))
            return core::fail(
                ErrorCode::syntax,
                fmt::format("{}: use either @ and ^ or X and Y, not both", written(*word)),
                word->span);
    const bool incremental = execution.modal().distance == DistanceMode::incremental;
    const bool needs_place = incremental || !statement.polar_radius || !statement.polar_angle;
    if (needs_place && !(target[0] && target[1]))
        return core::fail(
            ErrorCode::missing_value,
            fmt::format(
                "{}: this is relative to the current position, which is unknown; give both @ and ^",
                written(first)),
            first.span);
    double radius = needs_place ? std::hypot(*target[0], *target[1]) : 0.0;
    double angle =
        needs_place ? std::atan2(*target[1], *target[0]) / core::radians_per_degree : 0.0;
    if (!statement.polar_angle && radius < 1e-9)
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{}: the tool is at the origin, which has no angle: add ^", written(first)),
            first.span);
    if (statement.polar_radius)
        radius = length_of(execution, *statement.polar_radius) + (incremental ? radius : 0.0);
    if (statement.polar_angle) angle = statement.polar_angle->value + (incremental ? angle : 0.0);
    target[0] = radius * std::cos(angle * core::radians_per_degree);
    target[1] = radius * std::sin(angle * core::radians_per_degree);
    return {};
}

} // namespace

core::Result<Position> target_of(const Execution& execution) {
    const ModalState& modal = execution.modal();
    Position target = modal.position;
    if (in_machine_coordinates(execution)) {
        if (auto checked = refuse_polar_words(execution); !checked)
            return tl::unexpected(std::move(checked).error());
        Position machine = machine_from_program(modal.offsets, modal.position);
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (const Word* word = execution.statement.word(axis_letters[axis]))
                machine[axis] =
                    axis_value(execution, axis, *word)
                    + (execution.dialect.machine_places_are_of_tip ? modal.offsets.tool[axis]
                                                                   : 0.0);
        const Position place = program_from_machine(without_rotary_tool(modal.offsets), machine);
        const bool turned = mixes_axes(modal.offsets);
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (execution.statement.word(axis_letters[axis]) || (turned && axis < 3))
                target[axis] = place[axis];
        return target;
    }
    if (execution.statement.polar_radius || execution.statement.polar_angle)
        if (auto placed = place_polar(execution, target); !placed)
            return tl::unexpected(std::move(placed).error());
    const bool polar = moves_by_radius_and_angle(execution);
    if (polar) place_by_radius_and_angle(execution, target);
    const PlaneAxes plane = axes_of(modal.plane);
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (!(execution.statement.letters & letter_bit(axis_letters[axis]))) continue;
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (polar && (axis == plane.first || axis == plane.second)) continue;
        const double value = axis_value(execution, axis, *word);
        const bool absolute = word->addressing == Addressing::modal
                                  ? modal.distance == DistanceMode::absolute
                                  : word->addressing == Addressing::absolute;
        if (absolute)
            target[axis] = value;
        else if (target[axis])
            *target[axis] += value;
    }
    if (auto pointed = point_by_vector(execution, target); !pointed)
        return tl::unexpected(std::move(pointed).error());
    if (auto placed = place_by_angle(execution, target); !placed)
        return tl::unexpected(std::move(placed).error());
    if (const auto axis = axis_left_out_of_rotation(execution))
        target[*axis] = (*modal.transforms.before_rotation)[*axis];
    return target;
}

core::Result<void> move(Execution& execution) {
    if (auto set = set_motion_mode(execution); !set) return set;
    if (auto checked = refuse_lone_arc(execution); !checked) return checked;
    const bool cycle_words = execution.statement.of(ModalGroup::cycle) && execution.modal().cycle;
    if (!has_motion_words(execution) && !cycle_words) return refuse_lone_machine_place(execution);
    if (in_machine_coordinates(execution)) return move_to_machine_place(execution);
    if (auto taken = take_polar_words(execution); !taken) return taken;
    warn_of_axis_left_out(execution);
    if (auto moved = move_as_modes_say(execution); !moved) return moved;
    forget_place_before_rotation(execution);
    return {};
}

namespace {

tl::unexpected<core::Error> unknown_place(const Execution& execution, size_t axis) {
    const Word& mover = moving_word(execution);
    return core::fail(
        ErrorCode::missing_value,
        fmt::format("{}: with G16 this is relative to the current position, which is unknown in {}",
                    written(mover), axis_letters[axis]),
        mover.span);
}

} // namespace

core::Result<void> take_polar_words(Execution& execution) {
    ModalState& modal = execution.modal();
    if (!modal.transforms.polar) return {};
    PolarPositions& polar = *modal.transforms.polar;
    const PlaneAxes axes = axes_of(modal.plane);
    const bool incremental = modal.distance == DistanceMode::incremental;
    if (const Word* word = execution.statement.word(axis_letters[axes.first])) {
        polar.origin = {};
        for (const size_t i : {size_t{0}, size_t{1}}) {
            const size_t axis = i == 0 ? axes.first : axes.second;
            if (!incremental) continue;
            if (!modal.position[axis]) return unknown_place(execution, axis);
            polar.origin[i] = *modal.position[axis];
        }
        polar.radius = length_of(execution, *word);
    }
    if (const Word* word = execution.statement.word(axis_letters[axes.second]))
        polar.angle_deg = word->value + (incremental ? polar.angle_deg.value_or(0.0) : 0.0);
    return {};
}

void place_by_radius_and_angle(const Execution& execution, Position& target) {
    const ModalState& modal = execution.modal();
    const PolarPositions& polar = *modal.transforms.polar;
    const PlaneAxes axes = axes_of(modal.plane);
    const core::Mat3 turn = turned_about(2, polar.angle_deg.value_or(0.0));
    const double radius = polar.radius.value_or(0.0);
    target[axes.first] = polar.origin[0] + radius * turn[0][0];
    target[axes.second] = polar.origin[1] + radius * turn[0][1];
}

namespace {

bool moves_in_machine(const Execution& execution) {
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    return action && action->code->tenths == tenths(53);
}

} // namespace

std::optional<size_t> axis_left_out_of_rotation(const Execution& execution) {
    const ModalState& modal = execution.modal();
    const auto& before = modal.transforms.before_rotation;
    if (!before || !modal.transforms.rotation || moves_in_machine(execution)
        || modal.distance == DistanceMode::incremental || modal.transforms.polar)
        return std::nullopt;
    const auto normal = static_cast<size_t>(modal.transforms.rotation->normal);
    const size_t first = (normal + 1) % 3, second = (normal + 2) % 3;
    const bool has_first = execution.statement.word(axis_letters[first]);
    const bool has_second = execution.statement.word(axis_letters[second]);
    if (has_first == has_second) return std::nullopt;
    const size_t left_out = has_first ? second : first;
    const auto &old = (*before)[left_out], &now = modal.position[left_out];
    if (old == now || (old && now && std::abs(*old - *now) < 1e-9)) return std::nullopt;
    return left_out;
}

void warn_of_axis_left_out(Execution& execution) {
    if (const auto axis = axis_left_out_of_rotation(execution))
        execution.warn(moving_word(execution).span,
                       fmt::format("the first move after G68 has no {} word, and where that axis "
                                   "goes depends on a parameter of the control: program both axes",
                                   axis_letters[*axis]));
}

void forget_place_before_rotation(Execution& execution) {
    ProgramTransforms& transforms = execution.modal().transforms;
    if (!transforms.before_rotation || !transforms.rotation) return;
    const auto normal = static_cast<size_t>(transforms.rotation->normal);
    for (const size_t axis : {(normal + 1) % 3, (normal + 2) % 3})
        if (execution.statement.word(axis_letters[axis])) {
            transforms.before_rotation.reset();
            return;
        }
}

} // namespace gcode

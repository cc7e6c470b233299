#include <algorithm>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "gcode/contour/spline.h"
#include "gcode/cycles/cycles.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/frame_codes.h"
#include "gcode/exec/readings.h"
#include "gcode/iso/iso.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// On controls with a default feed rate, the first feed move without F uses it.
void assume_feed(Execution& execution) {
    ModalState& modal = execution.modal();
    const double assumed = execution.dialect.assumed_feed;
    if (modal.feed || assumed == 0.0 || modal.feed_mode != FeedMode::per_minute) return;
    const Word& mover = moving_word(execution);
    execution.result.warnings.push_back(
        {Severity::warning, mover.span,
         fmt::format(
             "{}: {}; Grbl 1.1 stops here (error 22), older versions use {:g} mm/min, which "
             "is assumed",
             written(mover), no_feed_yet, assumed),
         core::rule_id("no-feed"), "Program F before the first feed move."});
    modal.feed = assumed;
}

core::Result<void> move_straight(Execution& execution, bool rapid) {
    if (!rapid) assume_feed(execution);
    FEELER_TRY(const Position end, target_of(execution));
    if (rapid) {
        const bool bends =
            execution.dialect.machine_move_bends && in_machine_coordinates(execution);
        execution.traverse(end, bends ? std::optional(core::RapidStyle::dogleg) : std::nullopt);
        return {};
    }
    const bool needs_way = execution.modal().feed_mode == FeedMode::inverse_time;
    const std::optional<double> way =
        needs_way ? distance_between(execution.modal().position, end) : std::nullopt;
    FEELER_TRY(const double rate, feed_rate(execution, way));
    execution.feed(end, rate_to(execution.modal(), end, rate));
    return {};
}

/// Whether the block has a motion code without an end point, which is a move to the current
/// position.
bool stands_alone(const Execution& execution) {
    const CodeWord* motion = execution.statement.of(ModalGroup::motion);
    return execution.dialect.motion_codes_move && motion
           && (is_straight(motion_of(motion->code->number))
               || is_arc(motion_of(motion->code->number)));
}

/// Reports G2 or G3 without any arc words as an error.
core::Result<void> refuse_lone_arc(const Execution& execution) {
    const Statement& statement = execution.statement;
    const CodeWord* motion = statement.of(ModalGroup::motion);
    if (!execution.dialect.motion_codes_move || !motion || !is_arc(motion_of(motion->code->number)))
        return {};
    for (const char letter : {'I', 'J', 'K', 'R'})
        if (statement.word(letter)) return {};
    return core::fail(ErrorCode::missing_value,
                      fmt::format("{} has no centre: add I, J or K, or the radius as R; if no arc "
                                  "is intended here, remove the code",
                                  written(*motion->word)),
                      motion->word->span);
}

/// Whether a motion code of the block uses the axis words that another code takes: they are the
/// tool offset of G43.1 and the end of the move, both.
///
/// Source: rs274 of LinuxCNC 2.9, which takes `G43.1 Z3 G0 X5` as an offset of X5 Z3 and a rapid
///         to X5 Z3.
bool shares_axes(const CodeWord& taker, const Statement& statement) {
    return taker.code->number == g_code(43, 1) && statement.of(ModalGroup::motion);
}

/// Whether the block has words that make the active motion code move.
bool has_motion_words(const Execution& execution) {
    const Statement& statement = execution.statement;
    if (!statement.has_axis_word() && stands_alone(execution)) return true;
    const CodeWord* taker = statement.axis_word_owner();
    if (taker && !shares_axes(*taker, statement)) return false;
    if (statement.has_axis_word()) return true;
    if (statement.of(ModalGroup::motion) && execution.dialect.motion_codes_move) return true;
    const ModalState& modal = execution.modal();
    if (!modal.cycle && is_straight(modal.motion) && tool_direction(execution)) return true;
    if (modal.cycle && execution.dialect.cycles_run_with_axes_or_r && statement.word('R'))
        return true;
    const bool arc = !modal.cycle && is_arc(modal.motion);
    return arc && (statement.word('I') || statement.word('J') || statement.word('K'));
}

/// Whether the code of a cycle makes it run in a block without axis words.
///
/// Source: Fanuc B-63944EN, 13.1, canned cycle for drilling: a block without X, Y, Z, R or another
///         axis does not drill.
bool runs_by_code(const Execution& execution) {
    return execution.statement.of(ModalGroup::cycle) && execution.modal().cycle
           && !execution.dialect.cycles_run_with_axes_or_r;
}

/// Whether a motion code applies to its block only: G5, G5.1, G5.3, G70 to G72.
bool acts_once(CodeNumber code) {
    return code == g_code(5) || code == g_code(5, 1) || code == g_code(5, 3)
           || (code >= g_code(70) && code < g_code(73));
}

/// Sets the active motion code, or clears it.
void set_motion(InterpreterState& state, std::optional<MotionCode> motion) {
    std::optional<MotionCode>& active = state.modal.motion;
    if (active == MotionCode::spline_control_point && motion != active)
        state.spline.write().gathering = {};
    active = motion;
    state.modal.motion_cancelled = !motion;
}

/// Resets the words of the active cycle for another cycle, keeping the initial level.
void forget_words(CannedCycle& cycle) {
    CannedCycle fresh;
    fresh.initial_level = cycle.initial_level;
    cycle = fresh;
}

/// Whether a code cannot share its block with motion codes even without axis words.
bool wants_axes_alone(const CodeWord& taker) {
    constexpr CodeNumber codes[] = {g_code(10), g_code(28), g_code(30), g_code(52), g_code(92)};
    return std::find(std::begin(codes), std::end(codes), taker.code->number) != std::end(codes);
}

/// Makes G0 to G3 and the cycles modal, even when another code takes the axis words.
core::Result<void> set_motion_mode(Execution& execution) {
    const Statement& statement = execution.statement;
    ModalState& modal = execution.modal();
    const CodeWord* taker = statement.axis_word_owner();
    const CodeWord* cycle = statement.of(ModalGroup::cycle);
    const CodeWord* motion = statement.of(ModalGroup::motion);
    const CodeWord* mover = cycle && cycle->code->uses_axes() ? cycle : motion;
    const bool homes = taker && taker->code->number != g_code(4)
                       && (statement.has_axis_word() || wants_axes_alone(*taker))
                       && !(mover == motion && shares_axes(*taker, statement));
    if (mover && homes && execution.dialect.axis_words_serve_one_code)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{} and {} both use the axis words of this block: split it into two blocks",
                        written(*taker->word), written(*mover->word)),
            mover->word->span);
    if (mover && taker && statement.has_axis_word() && shares_axes(*taker, statement))
        execution.warn(taker->word->span,
                       fmt::format("{}: each axis word of this block is a tool offset, and the end "
                                   "of the move of {}, too: use two blocks",
                                   written(*taker->word), written(*mover->word)));
    if (motion && !acts_once(motion->code->number)) {
        set_motion(execution.state, motion_of(motion->code->number));
        modal.cycle.reset();
    }
    if (!cycle) return {};
    if (execution.dialect.cycles_are_motions && !motion) set_motion(execution.state, {});
    if (cycle->code->number == g_code(80)) {
        modal.cycle.reset();
        return {};
    }
    const CodeNumber code = cycle->code->number;
    if (!modal.cycle)
        modal.cycle = CannedCycle{};
    else if (execution.dialect.cycles_are_rs274 && modal.cycle->code != code)
        forget_words(*modal.cycle);
    else if (modal.cycle->code != code)
        modal.cycle->shift = {};
    modal.cycle->code = code;
    return {};
}

/// Handles axis words before the first motion code: uses the power-on default of the control.
core::Result<void> move_without_mode(Execution& execution) {
    for (const Word& word : execution.block.words) {
        if (axis_letters.find(word.letter) == std::string_view::npos) continue;
        if (!execution.dialect.begins_with_g0)
            return core::fail(ErrorCode::missing_value,
                              fmt::format("{}: no motion code is active; program G0, G1, G2 or G3",
                                          written(word)),
                              word.span);
        const bool feeds = answer_to(execution.state, execution.environment,
                                     ControlQuestion::starts_with_feed, word.span.line);
        if (!execution.environment.control.answer(ControlQuestion::starts_with_feed))
            execution.warn(word.span,
                           fmt::format("{}: no motion code is active; {}, the power-on default of "
                                       "the control, is assumed",
                                       written(word), feeds ? "G1" : "G0"));
        execution.modal().motion = feeds ? MotionCode::straight : MotionCode::rapid;
        return move_straight(execution, !feeds);
    }
    return {};
}

/// RS274/NGC 3.5.14: G53 applies to its block only, with G0 or G1. On Fanuc controls it is a rapid
/// whatever the motion code; with G91 it is ignored.
core::Result<void> move_to_machine_position(Execution& execution) {
    ModalState& modal = execution.modal();
    const CodeWord* action = execution.statement.of(ModalGroup::action);
    const bool incremental = modal.distance == DistanceMode::incremental;
    if (execution.dialect.machine_move_needs_g90 && incremental)
        return core::fail(ErrorCode::unsupported,
                          "G53 with G91 stops some controls and is ignored by others: use G90",
                          action->word->span);
    if (execution.dialect.machine_move_is_rapid) {
        std::array<bool, axis_count> moved{};
        for (size_t axis = 0; axis < axis_count; ++axis)
            moved[axis] = execution.statement.word(axis_letters[axis]) != nullptr;
        if (auto done = move_straight(execution, true); !done) return done;
        leave_length_behind(execution, moved);
        return {};
    }
    if (modal.cycle || !is_straight(modal.motion))
        return core::fail(ErrorCode::syntax, "G53 needs G0 or G1", action->word->span);
    return move_straight(execution, modal.motion == MotionCode::rapid);
}

/// Reports G53 in a block without a move as an error.
core::Result<void> refuse_lone_machine_position(const Execution& execution) {
    if (!execution.dialect.machine_move_needs_motion || !in_machine_coordinates(execution))
        return {};
    return core::fail(ErrorCode::missing_value,
                      "G53 applies to its own block only, and this block has no move: add G0 or G1 "
                      "and a position",
                      execution.statement.of(ModalGroup::action)->word->span);
}

core::Result<void> act_once(Execution& execution, CodeNumber code) {
    if (code >= g_code(70)) return turn_contour(execution);
    return code == g_code(5, 3) ? finish_spline(execution) : follow_spline(execution);
}

core::Result<void> move_as_modes_say(Execution& execution) {
    const ModalState& modal = execution.modal();
    const CodeWord* motion = execution.statement.of(ModalGroup::motion);
    if (motion && acts_once(motion->code->number)) return act_once(execution, motion->code->number);
    const bool threads = modal.cycle && modal.cycle->code == g_code(76);
    if (threads && execution.dialect.cycles_are_rs274) return cut_thread(execution);
    if (modal.cycle) return run_canned_cycle(execution);
    if (!modal.motion) return move_without_mode(execution);
    if (is_straight(modal.motion))
        return move_straight(execution, modal.motion == MotionCode::rapid);
    if (is_arc(modal.motion)) {
        if (auto checked = check_end_of_arc(execution); !checked) return checked;
        assume_feed(execution);
        return move_along_arc(execution);
    }
    if (modal.motion == MotionCode::spline_control_point) return gather_control_point(execution);
    const bool threads_along =
        modal.motion == MotionCode::spindle_feed || modal.motion == MotionCode::rigid_tap;
    return threads_along ? feed_with_spindle(execution) : probe(execution);
}

} // namespace

core::Result<void> move(Execution& execution) {
    if (auto set = set_motion_mode(execution); !set) return set;
    if (auto checked = refuse_lone_arc(execution); !checked) return checked;
    if (!has_motion_words(execution) && !runs_by_code(execution))
        return refuse_lone_machine_position(execution);
    if (in_machine_coordinates(execution)) return move_to_machine_position(execution);
    if (auto taken = read_polar_words(execution); !taken) return taken;
    warn_of_axis_left_out(execution);
    if (auto moved = move_as_modes_say(execution); !moved) return moved;
    forget_position_before_rotation(execution);
    return {};
}

} // namespace gcode

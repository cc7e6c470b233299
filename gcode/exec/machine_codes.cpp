#include <fmt/format.h>

#include "gcode/exec/execution.h"
#include "gcode/exec/following.h"
#include "gcode/exec/modes.h"
#include "gcode/exec/probing.h"
#include "gcode/exec/program_parameters.h"

namespace gcode {
namespace {

using core::ErrorCode;

core::Result<int> number_under(const Execution& execution, const CodeWord& entry, char letter,
                               int highest = 9999) {
    const Word* word = execution.statement.word(letter);
    if (!word)
        return core::fail(ErrorCode::missing_value,
                          fmt::format("{} needs a {} word", written(*entry.word), letter),
                          entry.word->span);
    return whole_number(*word, 0, highest);
}

/// M62 to M65: a digital output on or off. M67, M68: an analogue one.
core::Result<void> set_output(Execution& execution, const CodeWord& entry) {
    const CodeNumber code = entry.code->number;
    const bool analog = code == m_code(67) || code == m_code(68);
    FEELER_TRY(const int number, number_under(execution, entry, analog ? 'E' : 'P'));
    double value = code == m_code(62) || code == m_code(64) ? 1.0 : 0.0;
    if (analog) {
        const Word* word = execution.statement.word('Q');
        value = word ? word->value : -1.0;
    }
    if (analog && execution.environment.kinematics
        && execution.environment.kinematics->output == number)
        if (auto done = switch_kinematics(execution, entry.word->span, written(*entry.word), value);
            !done)
            return done;
    // What is connected in another way is not known.
    if (execution.environment.kinematics && !execution.environment.kinematics->output)
        switch_following(execution, entry.word->span, written(*entry.word),
                         FollowingSwitch::perhaps);
    const bool with_motion = code == m_code(62) || code == m_code(63) || code == m_code(67);
    execution.emit(SetOutput{number, value, analog, with_motion});
    return {};
}

/// M66: the input counts as off. A check also follows the other outcome of conditions on #5399.
core::Result<void> wait_for_input(Execution& execution, const CodeWord& entry) {
    const bool digital = execution.statement.word('P') != nullptr;
    const bool analog = execution.statement.word('E') != nullptr;
    if (digital == analog)
        return core::fail(ErrorCode::missing_value,
                          "M66 needs the number of an input: P for a digital one or E for an "
                          "analogue one, not both",
                          entry.word->span);
    FEELER_TRY(const int number, number_under(execution, entry, digital ? 'P' : 'E'));
    int kind = 0;
    if (const Word* word = execution.statement.word('L')) {
        FEELER_TRY(kind, whole_number(*word, 0, 4));
    }
    const Word* time = execution.statement.word('Q');
    if (kind > 0 && (analog || !time || time->value <= 0.0))
        return core::fail(ErrorCode::invalid_value,
                          analog ? "M66 can wait for digital inputs only: use E with L0"
                                 : "M66 L1 to L4 waits: it needs a Q word, the longest time",
                          entry.word->span);
    execution.modal().following.awaits_sync = false;
    execution.emit(WaitForInput{number, analog, kind > 0 ? time->value : 0.0});
    execution.state.parameters.write().set_numbered(5399, 0.0);
    ProgramParameters(execution.state, execution.environment).renew(5399);
    return {};
}

/// M109 of Haas: the operator's answer is the value of a variable.
///
/// Source: Haas, Mill Operator's Manual, M109 Interactive User Input.
core::Result<void> ask_operator(Execution& execution, const CodeWord& entry) {
    FEELER_TRY(const int number, number_under(execution, entry, 'P', highest_parameter));
    const int short_number = number > 10000 ? number - 10000 : number;
    if (short_number < 500 || short_number > 549)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("M109 P{}: P must be 500 to 549 or 10500 to 10549, the "
                                      "variable for the answer",
                                      number),
                          entry.word->span);
    const auto& stated = execution.environment.control.values;
    const auto known = stated.find(number);
    ProgramParameters parameters(execution.state, execution.environment);
    const double answer = known == stated.end() ? 0.0 : known->second;
    if (auto done = parameters.set_numbered(number, answer, entry.word->span); !done) return done;
    if (known == stated.end())
        parameters.mark_unknown(number);
    else
        parameters.mark_numbered(number, std::nullopt);
    return {};
}

void enable(Execution& execution, OverrideKind kind, bool enabled) {
    ModalState& modal = execution.modal();
    switch (kind) {
    case OverrideKind::feed:
        modal.feed_override = enabled;
        break;
    case OverrideKind::speed:
        modal.speed_override = enabled;
        break;
    case OverrideKind::adaptive_feed:
        modal.adaptive_feed = enabled;
        break;
    default:
        modal.feed_hold = enabled;
        break;
    }
    execution.emit(EnableOverride{kind, enabled});
}

} // namespace

core::Result<void> switch_machine(Execution& execution) {
    for (const CodeWord& entry : execution.statement.codes()) {
        const CodeNumber code = entry.code->number;
        if (code == m_code(66)) {
            if (auto done = wait_for_input(execution, entry); !done) return done;
        } else if (code == m_code(109)) {
            if (auto done = ask_operator(execution, entry); !done) return done;
        } else if (code >= m_code(62) && code <= m_code(68)) {
            if (auto done = set_output(execution, entry); !done) return done;
        }
    }
    return {};
}

core::Result<void> save_or_restore_modes(Execution& execution) {
    if (!execution.dialect.has_o_words) return {}; // M73 has other meanings elsewhere
    InterpreterState& state = execution.state;
    for (const CodeWord& entry : execution.statement.codes()) {
        const CodeNumber code = entry.code->number;
        if (code < m_code(70) || code > m_code(73)) continue;
        Frame& frame = state.frames.back();
        if (code == m_code(71)) {
            frame.saved.write().reset();
        } else if (code == m_code(72)) {
            if (!*frame.saved)
                return core::fail(
                    ErrorCode::missing_value,
                    "M72 has no modes to restore: no M70 saved them on this call level",
                    entry.word->span);
            const ModalState before = state.modal;
            for (const std::string& loss : losses_of_restoring(before, **frame.saved))
                execution.warn(entry.word->span, "M72: " + loss);
            restore_modes(state, **frame.saved);
            announce_modes(execution.result, entry.word->span.column, before, state.modal);
        } else {
            frame.saved.write() = state.modal;
            frame.restores = code == m_code(73);
        }
    }
    return {};
}

core::Result<void> set_overrides(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::overrides);
    if (!entry) return {};
    const CodeNumber code = entry->code->number;
    if (code == m_code(48) || code == m_code(49)) {
        enable(execution, OverrideKind::feed, code == m_code(48));
        enable(execution, OverrideKind::speed, code == m_code(48));
        return {};
    }
    const Word* word = execution.statement.word('P');
    const bool on = !word || word->value != 0.0;
    constexpr OverrideKind kinds[] = {OverrideKind::feed, OverrideKind::speed,
                                      OverrideKind::adaptive_feed, OverrideKind::feed_hold};
    enable(execution, kinds[whole_of(code) - 50], on);
    return {};
}

core::Result<void> feed_with_spindle(Execution& execution) {
    ModalState& modal = execution.modal();
    const Word& mover = moving_word(execution);
    const Word* pitch = execution.statement.word('K');
    if (!pitch)
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{} needs a K word, the distance per revolution of the spindle",
                        written(mover)),
            mover.span);
    const bool back_again = modal.motion == MotionCode::rigid_tap;
    if (back_again && modal.spindle == core::SpindleDirection::stopped)
        return core::fail(ErrorCode::missing_value,
                          "G33.1: the spindle is stopped: start it with M3 or M4 first",
                          mover.span);
    FEELER_TRY(const Position end, target_of(execution));
    execution.emit(ThreadFeed{end, length_of(execution, *pitch), back_again});
    if (!back_again) modal.position = end;
    return {};
}

core::Result<void> probe(Execution& execution) {
    ModalState& modal = execution.modal();
    const Word& mover = moving_word(execution);
    if (modal.feed_mode != FeedMode::per_minute)
        return core::fail(
            ErrorCode::syntax,
            fmt::format("{}: probing needs feed per minute: program G94 first", written(mover)),
            mover.span);
    FEELER_TRY(const Position end, target_of(execution));
    const std::optional<double> way = distance_between(modal.position, end);
    FEELER_TRY(const double rate, feed_rate(execution, way));
    if (way && *way < 0.254)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("{}: the probe move is too short", written(mover)),
                          mover.span);
    const MotionCode kind = *modal.motion;
    const bool towards = kind == MotionCode::probe_toward || kind == MotionCode::try_probe_toward;
    const bool must_succeed = kind == MotionCode::probe_toward || kind == MotionCode::probe_away;
    execution.warn(mover.span,
                   fmt::format("{}: where the probe makes contact is unknown; the whole move is "
                               "checked, and it may end anywhere on its way",
                               written(mover)),
                   Severity::note);
    probe_to(execution, {end, rate, towards, must_succeed});
    Parameters& parameters = execution.state.parameters.write();
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const double value = end[axis].value_or(0.0);
        parameters.set_numbered(static_cast<int>(5061 + axis),
                                is_rotary(axis) ? value : from_mm(value, modal.unit));
    }
    parameters.set_numbered(5070, 1.0);
    ProgramParameters renewed(execution.state, execution.environment);
    for (int number = 5061; number <= 5070; ++number) renewed.renew(number);
    return {};
}

namespace {

/// M2 and M30 where the control then runs the lines after them: sets back some of the modes.
///
/// Source: Grbl 1.1, gcode.c, gc_execute_line, step 21.
void set_modes_back(Execution& execution, const core::SourceSpan where) {
    use_work_offset(execution, 0);
    ModalState& modal = execution.modal();
    const ModalState before = modal;
    modal.motion = MotionCode::straight;
    modal.motion_cancelled = false;
    modal.plane = Plane::xy;
    modal.distance = DistanceMode::absolute;
    if (modal.feed_mode != FeedMode::per_minute) modal.feed.reset();
    modal.feed_mode = FeedMode::per_minute;
    modal.spindle = core::SpindleDirection::stopped;
    modal.mist = modal.flood = false;
    announce_modes(execution.result, where.column, before, modal);
    execution.state.after_end = true;
}

} // namespace

core::Result<void> stop(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::stopping);
    if (!entry) return {};
    switch (entry->code->number) {
    case m_code(1):
        execution.emit(OptionalStop{});
        break;
    case m_code(2):
    case m_code(30):
        execution.emit(ProgramEnd{});
        if (execution.dialect.runs_on_after_end)
            set_modes_back(execution, entry->word->span);
        else
            execution.state.ending = ProgramStatus::program_end;
        break;
    default:
        execution.emit(ProgramStop{});
        break; // M0, M60
    }
    return {};
}

} // namespace gcode

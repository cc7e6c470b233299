#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "gcode/exec/execution.h"
#include "gcode/exec/probing.h"
#include "gcode/exec/readings.h"
#include "gcode/language/control.h"

namespace gcode {
namespace {

/// A reference point in machine coordinates; if not given, machine zero with a warning on first
/// use.
Position known_home(Execution& execution, Position home, core::SourceSpan where,
                    const std::string& mover) {
    const bool known = home[0] && home[1] && home[2];
    if (!known && !execution.state.said_home) {
        execution.state.said_home = true;
        execution.warn(
            where, fmt::format("{}: the home position is not given and assumed to be machine zero",
                               mover));
    }
    for (std::optional<double>& axis : home)
        if (!axis) axis = 0.0;
    return home;
}

/// A position with the axes beyond X, Y and Z at 0 where it does not state them.
Position with_others_at_zero(Position position) {
    for (size_t axis = 3; axis < axis_count; ++axis)
        if (!position[axis]) position[axis] = 0.0;
    return position;
}

/// The position that G28.1 or G30.1 has stored: that of G28 or G30. Unknown unless the set-up or
/// the program states it.
Position stored_home(Execution& execution, bool is_first, core::SourceSpan where,
                     const std::string& mover) {
    const Position& home = is_first ? execution.modal().home : execution.modal().second_home;
    if (!(home[0] && home[1] && home[2])) {
        std::string_view place = is_first ? "`home` of the axes" : "the second reference point";
        if (execution.dialect.has_variables_file)
            place = is_first ? "`home` of the axes or the variables file (`parameters`)"
                             : "the variables file (`parameters`)";
        execution.result.warnings.push_back(
            {Severity::warning, where,
             fmt::format("{0} goes to the position that {1}.1 has stored, which only the machine "
                         "knows: the program does not store it before",
                         mover, is_first ? "G28" : "G30"),
             core::rule_id("unknown-value"),
             fmt::format("Retract with G53 G0 Z0 instead, or state {} in the set-up.", place)});
    }
    return with_others_at_zero(home);
}

/// The second reference point, which the machine builder or the operator has chosen.
Position second_home(Execution& execution, core::SourceSpan where, const std::string& mover) {
    const Position& home = execution.modal().second_home;
    if (!(home[0] && home[1] && home[2])) {
        std::string cure = "Retract with G53 G0 Z0 instead.";
        for (const char* key : {"1241", "second home"})
            if (find_setting(key, execution.dialect.id))
                cure = fmt::format("State \"{}\" under [control] in the set-up.", key);
        execution.result.warnings.push_back(
            {Severity::warning, where,
             fmt::format("{} goes to the second reference point, which only the machine knows",
                         mover),
             core::rule_id("unknown-value"), std::move(cure)});
    }
    return with_others_at_zero(home);
}

/// The reference point of G28 or G30 on this control.
Position reference_point(Execution& execution, bool is_first, core::SourceSpan where,
                         const std::string& mover) {
    if (execution.dialect.stores_homes && execution.environment.control.reports_premises)
        return stored_home(execution, is_first, where, mover);
    if (!is_first && execution.environment.control.follows_start)
        return second_home(execution, where, mover);
    return known_home(execution, is_first ? execution.modal().home : execution.modal().second_home,
                      where, mover);
}

Position home_of(Execution& execution, const CodeWord& entry) {
    const Word* p_word = execution.statement.word('P');
    if (entry.code->number == g_code(30) && p_word && p_word->value >= 3.0) {
        Position home;
        const AxisValues& stated =
            *execution.environment.further_homes[p_word->value == 3.0 ? 0 : 1];
        std::copy(stated.begin(), stated.end(), home.begin());
        return home;
    }
    return reference_point(execution, entry.code->number == g_code(28), entry.word->span,
                           written(*entry.word));
}

/// A rapid to a position in machine coordinates; axes without a value stay.
void traverse_in_machine(Execution& execution, const Position& to) {
    const ModalState& modal = execution.modal();
    const Offsets offsets = counted_offsets(modal.offsets);
    Position machine = machine_from_program(offsets, modal.position);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (to[axis]) machine[axis] = to[axis];
    const bool turned = mixes_axes(offsets);
    const Position position = program_from_machine(without_rotary_tool(offsets), machine);
    Position end = modal.position;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (to[axis] || (turned && axis < 3)) end[axis] = position[axis];
    if (end != modal.position) execution.traverse(end);
}

/// Stores the intermediate point for G29. Axes that this block does not name keep theirs.
void keep_way_home(Execution& execution, bool all) {
    ModalState& modal = execution.modal();
    const Position machine = machine_from_program(counted_offsets(modal.offsets), modal.position);
    if (!modal.way_home) modal.way_home = machine;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (all || execution.statement.word(axis_letters[axis]))
            (*modal.way_home)[axis] = machine[axis];
}

} // namespace

core::Result<void> go_home(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    ModalState& modal = execution.modal();
    execution.result.is_cycle = execution.result.goes_home = true;
    const bool all = !execution.statement.has_axis_word();
    if (!all) {
        FEELER_TRY(const Position between, target_of(execution));
        execution.traverse(between);
    }
    keep_way_home(execution, all);
    const Position home = home_of(execution, entry);
    const Offsets offsets = counted_offsets(modal.offsets);
    Position machine = machine_from_program(offsets, modal.position);
    std::array<bool, axis_count> moves{};
    for (size_t axis = 0; axis < axis_count; ++axis) {
        moves[axis] = all || execution.statement.word(axis_letters[axis]);
        if (moves[axis]) machine[axis] = home[axis];
    }
    // In a rotated frame, a motion of one machine axis changes all three coordinates. With a
    // rotated work offset, LinuxCNC moves along the axes of the program instead.
    const bool turned = offsets.has_frame || is_fixed_to_work(offsets);
    const Position position =
        program_from_machine(without_rotary_tool(offsets), turned ? machine : home);
    Position end = modal.position;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (moves[axis] || (turned && axis < 3)) end[axis] = position[axis];
    // Fanuc B-63944EN, 4.1, positioning (G00): with LRP = 1, too, G53 and the way from the
    // intermediate point to the reference point are not straight.
    execution.traverse(end, execution.dialect.machine_move_bends
                                ? std::optional(core::RapidStyle::dogleg)
                                : std::nullopt);
    if (entry.code->number == g_code(28) && execution.dialect.home_cancels_length) {
        cancel_length_offset(execution);
        execution.state.rules.length_cancelled = modal.tool.has_value();
    }
    leave_length_behind(execution, moves);
    return {};
}

void move_to_tool_change(Execution& execution, bool exchanges) {
    const ToolChangeMotion& motion = execution.environment.tool_change;
    if (motion.quill_up || (exchanges && execution.dialect.change_raises_z)) {
        Position up;
        up[2] = 0.0;
        traverse_in_machine(execution, up);
    }
    if (motion.goes_to_second_home)
        traverse_in_machine(
            execution, reference_point(execution, false,
                                       {.line = execution.block.line, .column = execution.column},
                                       "the tool change"));
    traverse_in_machine(execution, motion.position);
}

core::Result<void> check_home(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    const ModalState& modal = execution.modal();
    FEELER_TRY(const Position end, target_of(execution));
    execution.traverse(end);
    const Position machine = machine_from_program(counted_offsets(modal.offsets), modal.position);
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        const std::optional<double>& home = modal.home[axis];
        if (!word || !home || !machine[axis] || std::abs(*machine[axis] - *home) < 0.002) continue;
        execution.warn(word->span,
                       fmt::format("{}: not at the reference point: the machine is at {}{:.3f} and "
                                   "the reference point at {:.3f}, so the control stops here",
                                   written(*entry.word), axis_letters[axis], *machine[axis],
                                   *home));
    }
    return {};
}

core::Result<void> return_from_home(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    ModalState& modal = execution.modal();
    execution.result.is_cycle = true;
    if (!modal.way_home)
        return core::fail(
            core::ErrorCode::missing_value,
            "G29 returns through the intermediate point of G28, but no G28 came before it",
            entry.word->span);
    const Position between = program_from_machine(counted_offsets(modal.offsets), *modal.way_home);
    Position over = modal.position;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (execution.statement.word(axis_letters[axis])) over[axis] = between[axis];
    execution.traverse(over);
    // With G91 the words are relative to the intermediate point.
    FEELER_TRY(const Position end, target_of(execution));
    execution.traverse(end);
    return {};
}

core::Result<void> move_one_way(Execution& execution) {
    const Word& word = *execution.statement.of(ModalGroup::action)->word;
    const auto& approach = execution.environment.one_way_approach;
    if (!approach)
        return core::fail(
            core::ErrorCode::unsupported,
            fmt::format("{}: the control moves past the end point and back, by a distance that is "
                        "not known here: state it under [control] in the set-up (Fanuc 5440, "
                        "Haas setting 35), or program that point and then the end with G0",
                        written(word)),
            word.span);
    if (answer_to(execution.state, execution.environment, ControlQuestion::one_way_is_modal,
                  execution.block.line))
        return core::fail(core::ErrorCode::unsupported,
                          fmt::format("{}: G60 that stays active (parameter 5431#0 = 1) is not "
                                      "supported: program the points with G0",
                                      written(word)),
                          word.span);
    FEELER_TRY(const Position end, target_of(execution));
    Position before = end;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (before[axis] && execution.statement.word(axis_letters[axis]))
            *before[axis] -= (*approach)[axis];
    execution.traverse(before);
    execution.traverse(end);
    return {};
}

core::Result<void> skip_move(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    FEELER_TRY(const Position end, target_of(execution));
    FEELER_TRY(const double rate,
               feed_rate(execution, distance_between(execution.modal().position, end)));
    execution.warn(
        entry.word->span,
        fmt::format("{}: where the skip signal stops the move is unknown; the whole move is "
                    "checked, and it may end anywhere on its way",
                    written(*entry.word)),
        Severity::note);
    probe_to(execution, {end, rate, true, false});
    return {};
}

/// Haas: a skip move whose end sets the diameter of a tool (G35) or the work offset (G36, G136).
///
/// Source: Haas mill operator's manual 96-8000, G35, G36 and G136.
core::Result<void> measure(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    if (!execution.statement.has_axis_word())
        return core::fail(
            core::ErrorCode::missing_value,
            fmt::format("{} needs an axis word, the end of its move", written(*entry.word)),
            entry.word->span);
    const std::string_view what =
        entry.code->number == g_code(35) ? "tool diameter" : "work offset";
    execution.warn(entry.word->span,
                   fmt::format("{}: the {} that is measured is assumed to be the one that the "
                               "control has already",
                               written(*entry.word), what));
    return skip_move(execution);
}

core::Result<void> forbid_area(Execution& execution) {
    const Word& word = *execution.statement.of(ModalGroup::action)->word;
    execution.warn(word.span,
                   fmt::format("{}: the forbidden area is not modelled: the control would stop at "
                               "it, and the program is checked as if it goes on",
                               written(word)),
                   Severity::note);
    return {};
}

core::Result<void> store_home(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    ModalState& modal = execution.modal();
    Position& home = entry.code->number == g_code(28, 1) ? modal.home : modal.second_home;
    const Position machine = machine_from_program(counted_offsets(modal.offsets), modal.position);
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (machine[axis])
            home[axis] = machine[axis];
        else
            execution.warn(entry.word->span,
                           fmt::format("{}: the {} position is unknown and is not stored",
                                       written(*entry.word), axis_letters[axis]));
    }
    return {};
}

} // namespace gcode

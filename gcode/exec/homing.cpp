#include <cmath>

#include <fmt/format.h>

#include "gcode/exec/execution.h"

namespace gcode {
namespace {

/// Home in machine coordinates; if not given, machine zero with a warning on first use.
Position home_of(Execution& execution, const CodeWord& entry) {
    Position home =
        entry.code->number == g_code(28) ? execution.modal().home : execution.modal().second_home;
    const bool known = home[0] && home[1] && home[2];
    if (!known && !execution.state.said_home) {
        execution.state.said_home = true;
        execution.warn(
            entry.word->span,
            fmt::format("{}: the home position is not given and assumed to be machine zero",
                        written(*entry.word)));
    }
    for (std::optional<double>& axis : home)
        if (!axis) axis = 0.0;
    return home;
}

/// Stores the intermediate point for G29. Axes that this block does not name keep theirs.
void keep_way_home(Execution& execution, bool all) {
    ModalState& modal = execution.modal();
    const Position machine = machine_from_program(modal.offsets, modal.position);
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
    Position machine = machine_from_program(modal.offsets, modal.position);
    std::array<bool, axis_count> moves{};
    for (size_t axis = 0; axis < axis_count; ++axis) {
        moves[axis] = all || execution.statement.word(axis_letters[axis]);
        if (moves[axis]) machine[axis] = home[axis];
    }
    // In a rotated frame, a motion of one machine axis changes all three coordinates. With a
    // rotated work offset, LinuxCNC moves along the axes of the program instead.
    const bool turned = modal.offsets.has_frame || is_fixed_to_work(modal.offsets);
    const Position position =
        program_from_machine(without_rotary_tool(modal.offsets), turned ? machine : home);
    Position end = modal.position;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (moves[axis] || (turned && axis < 3)) end[axis] = position[axis];
    execution.traverse(end);
    return {};
}

core::Result<void> check_home(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    const ModalState& modal = execution.modal();
    FEELER_TRY(const Position end, target_of(execution));
    execution.traverse(end);
    const Position machine = machine_from_program(modal.offsets, modal.position);
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
    const Position between = program_from_machine(modal.offsets, *modal.way_home);
    Position over = modal.position;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (execution.statement.word(axis_letters[axis])) over[axis] = between[axis];
    execution.traverse(over);
    // With G91 the words are relative to the intermediate point.
    FEELER_TRY(const Position end, target_of(execution));
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
        fmt::format(
            "{}: where the skip signal stops the move is unknown; the whole move is checked",
            written(*entry.word)));
    execution.modal().position = end;
    execution.emit(StraightProbe{end, rate, true, false});
    return {};
}

core::Result<void> store_home(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    ModalState& modal = execution.modal();
    Position& home = entry.code->number == g_code(28, 1) ? modal.home : modal.second_home;
    const Position machine = machine_from_program(modal.offsets, modal.position);
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

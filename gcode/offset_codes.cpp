#include <fmt/format.h>

#include "gcode/execution.h"

namespace gcode {
namespace {

using core::ErrorCode;

/// Which work offset a P word means: 1 is G54, 0 the active one.
core::Result<size_t> work_offset_index(const Execution& execution, const CodeWord& entry) {
    const Word* word = execution.statement.word('P');
    if (!word)
        return core::fail(ErrorCode::missing_value,
                          "G10 does not say which work offset: it needs a P word",
                          entry.word->span);
    FEELER_TRY(const int number, whole_number(*word, 0, plain_offset_count));
    if (number > 0) return static_cast<size_t>(number - 1);
    if (!execution.dialect.p0_is_active_offset)
        return core::fail(ErrorCode::unsupported,
                          "P0: the external work offset is not supported yet", word->span);
    return execution.modal().offsets.active;
}

/// G10 L2: the origin itself, and how far it is turned. Under G91 some controls add to it.
void write_origin(const Execution& execution, WorkOffset& offset) {
    const bool adds = execution.dialect.offset_writes_follow_g91
                      && execution.modal().distance == DistanceMode::incremental;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[axis]))
            offset.origin[axis] =
                (adds ? offset.origin[axis] : 0.0) + axis_value(execution, axis, *word);
    if (const Word* word = execution.statement.word('R')) offset.rotation_deg = word->value;
}

/// G10 L20: the origin that makes the present place read as the words say.
core::Result<void> write_origin_here(const Execution& execution, WorkOffset& offset) {
    const ModalState& modal = execution.modal();
    const Position machine = machine_from_program(modal.offsets, modal.position);
    if (const Word* word = execution.statement.word('R')) offset.rotation_deg = word->value;
    Offsets there = modal.offsets;
    there.work = offset;
    Position read = program_from_machine(there, machine);
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word) continue;
        if (!read[axis])
            return core::fail(ErrorCode::missing_value,
                              fmt::format("{}: G10 L20 needs a known place, and where the machine "
                                          "is along {} is unknown",
                                          written(*word), axis_letters[axis]),
                              word->span);
        read[axis] = axis_value(execution, axis, *word);
    }
    // The origin moves by what the wanted reading is off from the machine's place.
    const Position meant = machine_from_program(there, read);
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (meant[axis] && machine[axis]) offset.origin[axis] += *machine[axis] - *meant[axis];
    return {};
}

/// Whether R may turn a work offset: not on all controls.
core::Result<void> check_turn(const Execution& execution) {
    const Word* word = execution.statement.word('R');
    if (!word || execution.dialect.work_offsets_turn) return {};
    return core::fail(
        ErrorCode::unsupported,
        fmt::format("{}: work offsets are not turned by this control; use G68", written(*word)),
        word->span);
}

/// The offset as it is in effect: what the table has, and Fanuc's external one.
WorkOffset in_effect(const Tables& tables, size_t index) {
    WorkOffset offset = work_offset(tables, index);
    for (size_t axis = 0; axis < axis_count; ++axis) offset.origin[axis] += tables.external[axis];
    return offset;
}

void use(Execution& execution, const Offsets& offsets) {
    change_offsets(execution, offsets);
    execution.emit(SetOffset{offsets});
}

} // namespace

void change_offsets(Execution& execution, const Offsets& offsets) {
    ModalState& modal = execution.modal();
    const auto turns = [](const Offsets& some) {
        return some.has_frame || some.work.rotation_deg != 0.0;
    };
    if (turns(modal.offsets) || turns(offsets)) {
        modal.position =
            program_from_machine(offsets, machine_from_program(modal.offsets, modal.position));
        modal.offsets = offsets;
        return;
    }
    const Position before = machine_minus_program(modal.offsets);
    const Position after = machine_minus_program(offsets);
    modal.offsets = offsets;
    for (size_t axis = 0; axis < axis_count; ++axis) {
        if (before[axis] == after[axis]) continue;
        std::optional<double>& place = modal.position[axis];
        if (place && before[axis] && after[axis])
            *place += *before[axis] - *after[axis];
        else
            place.reset();
    }
}

core::Result<void> select_offset(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::work_offset);
    if (!entry) return {};
    Offsets offsets = execution.modal().offsets;
    const int code = entry->code->tenths;
    offsets.active =
        static_cast<size_t>(code <= tenths(59) ? (code - tenths(54)) / 10 : 5 + code - tenths(59));
    offsets.work = in_effect(*execution.state.tables, offsets.active);
    use(execution, offsets);
    return {};
}

core::Result<void> write_offset(Execution& execution) {
    const CodeWord& entry = *execution.statement.of(ModalGroup::action);
    const Word* kind = execution.statement.word('L');
    if (!kind)
        return core::fail(ErrorCode::missing_value,
                          "G10 does not say what to write: it needs L2 "
                          "or L20",
                          entry.word->span);
    const bool is_tool = kind->value == 1.0 || kind->value == 10.0 || kind->value == 11.0;
    if (is_tool && execution.dialect.tool_entries_by_axes)
        return write_tool_entry(execution, static_cast<int>(kind->value));
    if (kind->value != 2.0 && kind->value != 20.0)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: only G10 L2 and L20 are supported yet", written(*kind)),
                          kind->span);
    FEELER_TRY(const size_t index, work_offset_index(execution, entry));
    if (auto checked = check_turn(execution); !checked) return checked;
    WorkOffset offset = work_offset(*execution.state.tables, index);
    if (kind->value == 2.0)
        write_origin(execution, offset);
    else if (auto done = write_origin_here(execution, offset); !done)
        return done;
    writable_work_offset(execution.state.tables.write(), index) = offset;
    Offsets offsets = execution.modal().offsets;
    if (index == offsets.active) offsets.work = in_effect(*execution.state.tables, index);
    use(execution, offsets);
    return {};
}

core::Result<void> set_local_offset(Execution& execution) {
    Offsets offsets = execution.modal().offsets;
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word) continue;
        const double value = axis_value(execution, axis, *word);
        if (execution.dialect.local_offset_is_axis_offset)
            offsets.axis[axis] = value;
        else
            offsets.local[axis] = value;
    }
    use(execution, offsets);
    return {};
}

core::Result<void> set_axis_offset(Execution& execution) {
    ModalState& modal = execution.modal();
    Offsets offsets = modal.offsets;
    switch (execution.statement.of(ModalGroup::action)->code->tenths) {
    case tenths(92, 1):
        offsets.axis = modal.suspended_axis = zero_position;
        break;
    case tenths(92, 2):
        modal.suspended_axis = offsets.axis;
        offsets.axis = zero_position;
        break;
    case tenths(92, 3):
        offsets.axis = modal.suspended_axis;
        break;
    default:
        for (size_t axis = 0; axis < axis_count; ++axis) {
            const Word* word = execution.statement.word(axis_letters[axis]);
            if (!word) continue;
            const std::optional<double> place = modal.position[axis];
            const double wanted = axis_value(execution, axis, *word);
            // The machine stays and this place takes a new name; of an unknown place, only the
            // name is known.
            if (place && offsets.axis[axis])
                *offsets.axis[axis] += *place - wanted;
            else
                offsets.axis[axis].reset();
        }
        modal.suspended_axis = offsets.axis;
        change_offsets(execution, offsets);
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (const Word* word = execution.statement.word(axis_letters[axis]))
                modal.position[axis] = axis_value(execution, axis, *word);
        execution.emit(SetOffset{offsets});
        return {};
    }
    use(execution, offsets);
    return {};
}

} // namespace gcode

#include <fmt/format.h>

#include "gcode/execution.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr char letters[] = {'X', 'Y', 'Z'};

core::Result<void> refuse_rotary_offsets(const Execution& execution) {
    for (const char letter : {'A', 'B', 'C', 'R'})
        if (const Word* word = execution.statement.word(letter); word && word->value != 0.0)
            return core::fail(
                ErrorCode::unsupported,
                fmt::format("{}: turned offsets are not supported yet", written(*word)),
                word->span);
    return {};
}

/// Which work offset a P word means: 1 is G54, 0 the active one.
core::Result<size_t> work_offset_index(const Execution& execution, const CodeWord& entry) {
    const Word* word = execution.statement.word('P');
    if (!word)
        return core::fail(ErrorCode::missing_value,
                          "G10 does not say which work offset: it needs a P word",
                          entry.word->span);
    FEELER_TRY(const int number, whole_number(*word, 0, work_offset_count));
    if (number > 0) return static_cast<size_t>(number - 1);
    if (!execution.dialect.p0_is_active_offset)
        return core::fail(ErrorCode::unsupported,
                          "P0: the external work offset is not supported yet", word->span);
    return execution.modal().offsets.active;
}

/// G10 L2: the origin itself. Under G91 some controls add to it.
void write_origin(const Execution& execution, core::Vec3& origin) {
    const bool adds = execution.dialect.offset_writes_follow_g91
                      && execution.modal().distance == DistanceMode::incremental;
    for (int axis = 0; axis < 3; ++axis)
        if (const Word* word = execution.statement.word(letters[axis]))
            origin[axis] = (adds ? origin[axis] : 0.0) + length_of(execution, *word);
}

/// G10 L20: the origin that makes the present place read as the words say.
core::Result<void> write_origin_here(const Execution& execution, Offsets& offsets, size_t index) {
    const Position machine = machine_from_program(offsets, execution.modal().position);
    Offsets there = offsets;
    there.active = index;
    const Position wanted = machine_minus_program(there);
    for (int axis = 0; axis < 3; ++axis) {
        const Word* word = execution.statement.word(letters[axis]);
        if (!word) continue;
        if (!machine[axis] || !wanted[axis])
            return core::fail(ErrorCode::missing_value,
                              fmt::format("{}: G10 L20 needs a known place, and where the machine "
                                          "is along {} is unknown",
                                          written(*word), letters[axis]),
                              word->span);
        offsets.work[index][axis] += *machine[axis] - *wanted[axis] - length_of(execution, *word);
    }
    return {};
}

void use(Execution& execution, const Offsets& offsets) {
    change_offsets(execution, offsets);
    execution.emit(SetOffset{offsets});
}

} // namespace

void change_offsets(Execution& execution, const Offsets& offsets) {
    ModalState& modal = execution.modal();
    const Position before = machine_minus_program(modal.offsets);
    const Position after = machine_minus_program(offsets);
    modal.offsets = offsets;
    for (size_t axis = 0; axis < 3; ++axis) {
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
    if (kind->value != 2.0 && kind->value != 20.0)
        return core::fail(ErrorCode::unsupported,
                          fmt::format("{}: only G10 L2 and L20 are supported yet", written(*kind)),
                          kind->span);
    if (auto checked = refuse_rotary_offsets(execution); !checked) return checked;
    FEELER_TRY(const size_t index, work_offset_index(execution, entry));
    Offsets offsets = execution.modal().offsets;
    if (kind->value == 2.0)
        write_origin(execution, offsets.work[index]);
    else if (auto done = write_origin_here(execution, offsets, index); !done)
        return done;
    use(execution, offsets);
    return {};
}

core::Result<void> set_local_offset(Execution& execution) {
    if (auto checked = refuse_rotary_offsets(execution); !checked) return checked;
    Offsets offsets = execution.modal().offsets;
    for (int axis = 0; axis < 3; ++axis) {
        const Word* word = execution.statement.word(letters[axis]);
        if (!word) continue;
        const double length = length_of(execution, *word);
        if (execution.dialect.local_offset_is_axis_offset)
            offsets.axis[static_cast<size_t>(axis)] = length;
        else
            offsets.local[axis] = length;
    }
    use(execution, offsets);
    return {};
}

core::Result<void> set_axis_offset(Execution& execution) {
    if (auto checked = refuse_rotary_offsets(execution); !checked) return checked;
    ModalState& modal = execution.modal();
    Offsets offsets = modal.offsets;
    switch (execution.statement.of(ModalGroup::action)->code->tenths) {
    case tenths(92, 1):
        offsets.axis = offsets.suspended_axis = zero_position;
        break;
    case tenths(92, 2):
        offsets.suspended_axis = offsets.axis;
        offsets.axis = zero_position;
        break;
    case tenths(92, 3):
        offsets.axis = offsets.suspended_axis;
        break;
    default:
        for (size_t axis = 0; axis < 3; ++axis) {
            const Word* word = execution.statement.word(letters[axis]);
            if (!word) continue;
            const std::optional<double> place = modal.position[axis];
            const double wanted = length_of(execution, *word);
            // The machine stays and this place takes a new name; of an unknown place, only the
            // name is known.
            if (place && offsets.axis[axis])
                *offsets.axis[axis] += *place - wanted;
            else
                offsets.axis[axis].reset();
        }
        offsets.suspended_axis = offsets.axis;
        change_offsets(execution, offsets);
        for (size_t axis = 0; axis < 3; ++axis)
            if (const Word* word = execution.statement.word(letters[axis]))
                modal.position[axis] = length_of(execution, *word);
        execution.emit(SetOffset{offsets});
        return {};
    }
    use(execution, offsets);
    return {};
}

} // namespace gcode

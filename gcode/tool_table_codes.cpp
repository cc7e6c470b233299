#include <fmt/format.h>

#include "gcode/execution.h"

namespace gcode {
namespace {

using core::ErrorCode;
using core::OffsetNumber;
using core::ToolNumber;

core::Result<int> tool_of_entry(const Execution& execution) {
    const Word* word = execution.statement.word('P');
    if (!word)
        return core::fail(ErrorCode::missing_value,
                          "G10 does not say which tool: it needs a P word",
                          execution.statement.of(ModalGroup::action)->word->span);
    return whole_number(*word, 1, 99999);
}

core::Result<void> need_a_value(const Execution& execution) {
    const Statement& statement = execution.statement;
    for (const char letter : {'R', 'I', 'J', 'Q'})
        if (statement.word(letter)) return {};
    if (statement.has_axis_word()) return {};
    return core::fail(ErrorCode::missing_value,
                      "G10 does not say what to write into the tool table: it needs an axis word, "
                      "R, I, J or Q",
                      statement.of(ModalGroup::action)->word->span);
}

/// The radius, the angles and the way a turning tool points, which L1, L10 and L11 take alike.
core::Result<void> take_shape(const Execution& execution, LengthOffset& entry) {
    const Statement& statement = execution.statement;
    if (const Word* word = statement.word('R')) entry.diameter = 2.0 * length_of(execution, *word);
    if (const Word* word = statement.word('I')) entry.front_deg = word->value;
    if (const Word* word = statement.word('J')) entry.back_deg = word->value;
    if (const Word* word = statement.word('Q')) {
        FEELER_TRY(entry.orientation, whole_number(*word, 0, 9));
    }
    return {};
}

/// Of the frame in which L10 and L11 read the place: the active one, or that of G59.3.
Offsets reading_offsets(const Execution& execution, bool in_last_offset) {
    Offsets offsets = execution.modal().offsets;
    offsets.tool = {};
    if (in_last_offset) offsets.axis = zero_position;
    if (in_last_offset) offsets.work = work_offset(*execution.state.tables, plain_offset_count - 1);
    return offsets;
}

/// What an entry would shift, as a place without any other offset.
Position shift_of(const LengthOffset& entry) {
    Position shift;
    for (size_t axis = 0; axis < axis_count; ++axis)
        shift[axis] = axis == 2 ? entry.length : entry.shift[axis];
    return shift;
}

/// The tool offsets that would make the present place read as the words say. Where the offset is
/// turned, the entry keeps what it has along the turned axes that are not named.
core::Result<void> take_offsets_here(const Execution& execution, bool in_last_offset,
                                     LengthOffset& entry) {
    const ModalState& modal = execution.modal();
    const Position machine = machine_from_program(modal.offsets, modal.position);
    const Offsets offsets = reading_offsets(execution, in_last_offset);
    Offsets only_turned;
    only_turned.work.rotation_deg = offsets.work.rotation_deg;
    const Position read = program_from_machine(offsets, machine);
    Position off = program_from_machine(only_turned, shift_of(entry));
    for (size_t axis = 0; axis < axis_count; ++axis) {
        const Word* word = execution.statement.word(axis_letters[axis]);
        if (!word) continue;
        if (!read[axis])
            return core::fail(ErrorCode::missing_value,
                              fmt::format("{}: this needs a known place, and where the machine is "
                                          "along {} is unknown",
                                          written(*word), axis_letters[axis]),
                              word->span);
        off[axis] = *read[axis] - axis_value(execution, axis, *word);
    }
    const Position shift = machine_from_program(only_turned, off);
    for (size_t axis = 0; axis < axis_count; ++axis)
        (axis == 2 ? entry.length : entry.shift[axis]) = *shift[axis];
    return {};
}

} // namespace

core::Result<void> write_tool_entry(Execution& execution, int kind) {
    FEELER_TRY(const int tool, tool_of_entry(execution));
    if (auto checked = need_a_value(execution); !checked) return checked;
    std::map<OffsetNumber, LengthOffset>& lengths = execution.state.tables.write().lengths;
    LengthOffset entry;
    if (const auto known = lengths.find(OffsetNumber(tool)); known != lengths.end())
        entry = known->second;
    else if (const auto length = length_under(*execution.state.tables, tool))
        entry.length = *length;
    if (auto taken = take_shape(execution, entry); !taken) return taken;
    if (kind == 1) {
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (const Word* word = execution.statement.word(axis_letters[axis]))
                (axis == 2 ? entry.length : entry.shift[axis]) = axis_value(execution, axis, *word);
    } else if (auto taken = take_offsets_here(execution, kind == 11, entry); !taken) {
        return taken;
    }
    lengths[OffsetNumber(tool)] = entry;
    return {};
}

core::Result<void> name_tool(Execution& execution) {
    const Word* word = execution.statement.word('Q');
    if (!word)
        return core::fail(ErrorCode::missing_value,
                          "M61 does not say which tool is in the spindle: it needs a Q word",
                          execution.statement.of(ModalGroup::tool_change)->word->span);
    FEELER_TRY(const int tool, whole_number(*word));
    execution.modal().tool = ToolNumber(tool);
    execution.emit(NameTool{tool == 0 ? std::nullopt : std::optional(ToolNumber(tool))});
    return {};
}

} // namespace gcode

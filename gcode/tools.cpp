#include <algorithm>

#include <fmt/format.h>

#include "gcode/execution.h"
#include "gcode/frame_codes.h"

namespace gcode {
namespace {

using core::ErrorCode;
using core::OffsetNumber;
using core::ToolNumber;

void use_offset(Execution& execution, std::optional<OffsetNumber> number, const AxisValues& offset,
                bool follows_tip = false) {
    Offsets offsets = execution.modal().offsets;
    offsets.tool = offset;
    offsets.follows_tip = follows_tip;
    change_offsets(execution, offsets);
    execution.modal().length_number = number;
    execution.emit(UseToolLengthOffset{number, offset, follows_tip});
}

/// The offset under a number: along Z its length, else as the table says.
AxisValues offset_under(const Execution& execution, int number, double length) {
    AxisValues offset{};
    const auto& lengths = execution.state.tables->lengths;
    if (const auto entry = lengths.find(OffsetNumber(number)); entry != lengths.end())
        offset = entry->second.shift;
    offset[2] = length;
    return offset;
}

/// The number G43 means: its H word, else what the dialect says.
core::Result<std::optional<int>> length_number(const Execution& execution) {
    if (const Word* word = execution.statement.word('H')) {
        FEELER_TRY(const int number, whole_number(*word));
        if (number != 0 || !execution.dialect.bare_h0_is_tool) return number;
    }
    const ModalState& modal = execution.modal();
    if (execution.dialect.bare_length_offset_is_tool)
        return modal.tool ? std::optional(value_of(*modal.tool)) : std::nullopt;
    return modal.length_number ? std::optional(value_of(*modal.length_number)) : std::nullopt;
}

core::Result<void> use_table_length(Execution& execution, const Word& word, double sign,
                                    bool follows_tip = false) {
    FEELER_TRY(const std::optional<int> number, length_number(execution));
    execution.modal().length_sign = sign;
    const core::SourceSpan where = word.span;
    if (!number) {
        execution.warn(where, fmt::format("{} has no H word and no tool to take it from: no length "
                                          "offset is applied",
                                          written(word)));
        use_offset(execution, std::nullopt, {}, follows_tip);
        return {};
    }
    const std::optional<double> length =
        *number == 0 ? std::optional(0.0) : length_under(*execution.state.tables, *number);
    if (!length)
        execution.warn(where, fmt::format("{}: nothing is known about length offset H{}, taken as "
                                          "0",
                                          written(word), *number));
    use_offset(execution, OffsetNumber(*number),
               offset_under(execution, *number, sign * length.value_or(0.0)), follows_tip);
    const auto& tool = execution.modal().tool;
    if (tool && *number != 0 && *number != value_of(*tool))
        execution.result.warnings.push_back(
            {Severity::warning, where,
             fmt::format("{}: H{} is not the offset of the tool in the spindle, T{}", written(word),
                         *number, value_of(*tool)),
             "offset-not-tool", fmt::format("Write H{}.", value_of(*tool))});
    return {};
}

/// G43.1: the offset stands in the block.
core::Result<void> use_given_offset(Execution& execution) {
    AxisValues offset = execution.modal().offsets.tool;
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (const Word* word = execution.statement.word(axis_letters[axis]))
            offset[axis] = axis_value(execution, axis, *word);
    use_offset(execution, std::nullopt, offset);
    return {};
}

/// G43.2: one more offset on top of what is on, from the table or from the block.
core::Result<void> add_table_offset(Execution& execution, const Word& word) {
    AxisValues sum = execution.modal().offsets.tool;
    const Word* number = execution.statement.word('H');
    AxisValues more{};
    for (size_t axis = 0; axis < axis_count; ++axis)
        if (const Word* value = execution.statement.word(axis_letters[axis]))
            more[axis] = axis_value(execution, axis, *value);
    if (number) {
        FEELER_TRY(const int entry, whole_number(*number));
        const std::optional<double> length = length_under(*execution.state.tables, entry);
        if (!length)
            return core::fail(
                ErrorCode::invalid_value,
                fmt::format("{}: nothing is known about length offset H{}", written(word), entry),
                number->span);
        more = offset_under(execution, entry, *length);
    } else if (!execution.statement.has_axis_word()) {
        return core::fail(
            ErrorCode::missing_value,
            fmt::format("{} needs an H word, or the offset itself as axis words", written(word)),
            word.span);
    }
    for (size_t axis = 0; axis < axis_count; ++axis) sum[axis] += more[axis];
    use_offset(execution, execution.modal().length_number, sum);
    return {};
}

/// G43.4 and G43.5: the control keeps the tip where the program says, seen from the work.
core::Result<void> use_tool_centre_control(Execution& execution, const CodeWord& entry) {
    ProgramTransforms transforms = execution.modal().transforms;
    transforms.follows_vectors = entry.code->tenths == tenths(43, 5);
    use_transforms(execution, transforms);
    if (!execution.modal().offsets.machine)
        execution.warn(entry.word->span,
                       fmt::format("{}: taken as G43; rotary axes are followed in the program's "
                                   "coordinates, not in those of the machine",
                                   written(*entry.word)),
                       Severity::note);
    return use_table_length(execution, *entry.word, +1.0, true);
}

/// Once a plain length offset or none is on, motions do not say where the tool points to.
void leave_vectors(Execution& execution) {
    if (!execution.modal().transforms.follows_vectors) return;
    ProgramTransforms transforms = execution.modal().transforms;
    transforms.follows_vectors = false;
    use_transforms(execution, transforms);
}

} // namespace

bool changes_length_alone(const Execution& execution) {
    const auto uses = [](const CodeWord& entry) { return entry.code->uses('H'); };
    const std::span<const CodeWord> codes = execution.statement.codes();
    return execution.dialect.lone_h_is_length_offset && execution.modal().length_sign != 0.0
           && execution.statement.word('H') && !execution.statement.of(ModalGroup::tool_length)
           && std::none_of(codes.begin(), codes.end(), uses);
}

core::Result<void> select_tool(Execution& execution) {
    const Word* word = execution.statement.word('T');
    if (!word) return {};
    FEELER_TRY(const int number, whole_number(*word));
    const auto& table = execution.state.tables->lengths;
    if (execution.dialect.tool_entries_by_axes && number != 0 && !table.empty()
        && !length_under(*execution.state.tables, number))
        execution.warn(word->span, fmt::format("{}: this tool is not in the tool table: a control "
                                               "with this table stops here",
                                               written(*word)));
    execution.modal().selected_tool = ToolNumber(number);
    execution.emit(SelectTool{ToolNumber(number)});
    return {};
}

core::Result<void> change_tool(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::tool_change);
    if (!entry) return {};
    ModalState& modal = execution.modal();
    execution.column = entry->word->span.column;
    if (entry->code->tenths == tenths(61)) return name_tool(execution);
    if (!modal.selected_tool)
        return core::fail(ErrorCode::missing_value,
                          "M6 has no tool to change to: no T word came before it",
                          entry->word->span);
    modal.tool = modal.selected_tool;
    // RS274/NGC 3.6.3: the spindle is stopped when the tool change is complete.
    if (modal.spindle != core::SpindleDirection::stopped) {
        modal.spindle = core::SpindleDirection::stopped;
        execution.emit(Spindle{modal.spindle, 0.0});
    }
    const bool empty = *modal.tool == ToolNumber(0);
    execution.emit(ChangeTool{empty ? std::nullopt : modal.tool});
    return {};
}

core::Result<void> set_tool_length(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::tool_length);
    ModalState& modal = execution.modal();
    if (!entry && changes_length_alone(execution))
        return use_table_length(execution, *execution.statement.word('H'), modal.length_sign,
                                modal.offsets.follows_tip);
    if (!entry) return {};
    leave_vectors(execution);
    switch (entry->code->tenths) {
    case tenths(43):
        return use_table_length(execution, *entry->word, +1.0);
    case tenths(44):
        return use_table_length(execution, *entry->word, -1.0);
    case tenths(43, 2):
        return add_table_offset(execution, *entry->word);
    case tenths(43, 4):
    case tenths(43, 5):
        return use_tool_centre_control(execution, *entry);
    case tenths(43, 1):
        modal.length_sign = 0.0;
        return use_given_offset(execution);
    default:
        modal.length_sign = 0.0;
        use_offset(execution, std::nullopt, {});
        return {}; // G49
    }
}

} // namespace gcode

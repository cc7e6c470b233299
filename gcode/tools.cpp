#include <algorithm>

#include <fmt/format.h>

#include "gcode/execution.h"

namespace gcode {
namespace {

using core::ErrorCode;
using core::OffsetNumber;
using core::ToolNumber;

/// What the control has under a number: the table's entry, else the length of the tool of that
/// number; empty when it has neither.
std::optional<double> length_under(const Environment& environment, int number) {
    const auto entry = environment.length_offsets.find(OffsetNumber(number));
    if (entry != environment.length_offsets.end()) return entry->second.length + entry->second.wear;
    const auto tool = environment.tool_lengths.find(ToolNumber(number));
    if (tool != environment.tool_lengths.end()) return tool->second;
    return std::nullopt;
}

void use_length(Execution& execution, std::optional<OffsetNumber> number, double length) {
    Offsets offsets = execution.modal().offsets;
    offsets.tool_length = length;
    change_offsets(execution, offsets);
    execution.modal().length_number = number;
    execution.emit(UseToolLengthOffset{number, length});
}

/// The number G43 means: its H word, else what the dialect says.
core::Result<std::optional<int>> length_number(const Execution& execution) {
    if (const Word* word = execution.statement.word('H')) {
        FEELER_TRY(const int number, whole_number(*word));
        return number;
    }
    const ModalState& modal = execution.modal();
    if (execution.dialect.bare_length_offset_is_tool)
        return modal.tool ? std::optional(value_of(*modal.tool)) : std::nullopt;
    return modal.length_number ? std::optional(value_of(*modal.length_number)) : std::nullopt;
}

core::Result<void> use_table_length(Execution& execution, const Word& word, double sign) {
    FEELER_TRY(const std::optional<int> number, length_number(execution));
    execution.modal().length_sign = sign;
    const core::SourceSpan where = word.span;
    if (!number) {
        execution.warn(where, fmt::format("{} has no H word and no tool to take it from: no length "
                                          "offset is applied",
                                          written(word)));
        use_length(execution, std::nullopt, 0.0);
        return {};
    }
    const std::optional<double> length =
        *number == 0 ? std::optional(0.0) : length_under(execution.environment, *number);
    if (!length)
        execution.warn(where, fmt::format("{}: nothing is known about length offset H{}, taken as "
                                          "0",
                                          written(word), *number));
    use_length(execution, OffsetNumber(*number), sign * length.value_or(0.0));
    return {};
}

/// G43.1: the offset stands in the block.
core::Result<void> use_given_length(Execution& execution) {
    for (const char letter : {'X', 'Y'})
        if (const Word* word = execution.statement.word(letter); word && word->value != 0.0)
            return core::fail(
                ErrorCode::unsupported,
                fmt::format("{}: tool offsets along X and Y are not supported yet", written(*word)),
                word->span);
    const Word* word = execution.statement.word('Z');
    use_length(execution, std::nullopt,
               word ? length_of(execution, *word) : execution.modal().offsets.tool_length);
    return {};
}

} // namespace

bool changes_length_alone(const Execution& execution) {
    const auto uses = [](const CodeWord& entry) { return entry.code->uses('H'); };
    const std::vector<CodeWord>& codes = execution.statement.codes;
    return execution.dialect.lone_h_is_length_offset && execution.modal().length_sign != 0.0
           && execution.statement.word('H') && !execution.statement.of(ModalGroup::tool_length)
           && std::none_of(codes.begin(), codes.end(), uses);
}

core::Result<void> select_tool(Execution& execution) {
    const Word* word = execution.statement.word('T');
    if (!word) return {};
    FEELER_TRY(const int number, whole_number(*word));
    execution.modal().selected_tool = ToolNumber(number);
    execution.emit(SelectTool{ToolNumber(number)});
    return {};
}

core::Result<void> change_tool(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::tool_change);
    if (!entry) return {};
    ModalState& modal = execution.modal();
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
        return use_table_length(execution, *execution.statement.word('H'), modal.length_sign);
    if (!entry) return {};
    switch (entry->code->tenths) {
    case tenths(43):
        return use_table_length(execution, *entry->word, +1.0);
    case tenths(44):
        return use_table_length(execution, *entry->word, -1.0);
    case tenths(43, 1):
        modal.length_sign = 0.0;
        return use_given_length(execution);
    default:
        modal.length_sign = 0.0;
        use_length(execution, std::nullopt, 0.0);
        return {}; // G49
    }
}

} // namespace gcode

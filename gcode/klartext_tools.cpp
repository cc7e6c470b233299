#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gcode/klartext.h"

namespace gcode {
namespace {

using core::ErrorCode;
using core::OffsetNumber;
using core::ToolNumber;

// Q parameters in which the control shows the tool.
constexpr int q_radius = 108, q_axis = 109, q_length_of_tool = 114;

void put_into_spindle(Execution& execution, ToolNumber tool) {
    ModalState& modal = execution.modal();
    if (modal.tool == tool) return;
    modal.selected_tool = modal.tool = tool;
    execution.emit(SelectTool{tool});
    if (modal.spindle != core::SpindleDirection::stopped) {
        modal.spindle = core::SpindleDirection::stopped;
        execution.emit(Spindle{modal.spindle, 0.0});
    }
    execution.emit(ChangeTool{tool == ToolNumber(0) ? std::nullopt : std::optional(tool)});
}

double radius_of(const Execution& execution, int number) {
    const auto& lengths = execution.state.tables->lengths;
    const auto entry = lengths.find(OffsetNumber(number));
    return entry == lengths.end() ? 0.0 : entry->second.diameter / 2.0 + entry->second.radius_wear;
}

/// The tool's length counts from here on, and its size is shown to the program.
void use_length(Execution& execution, int number, const Word& tool) {
    const std::optional<double> length =
        number == 0 ? std::optional(0.0) : length_under(*execution.state.tables, number);
    if (!length)
        execution.warn(tool.span, fmt::format("{}: nothing is known about the length of tool {}, "
                                              "taken as 0",
                                              written(tool), number));
    const Word* longer = execution.statement.word('L');
    const Word* wider = execution.statement.word('D');
    Offsets offsets = execution.modal().offsets;
    offsets.tool = {};
    const size_t normal = axes_of(execution.modal().plane).normal;
    offsets.tool[normal] = length.value_or(0.0) + (longer ? length_of(execution, *longer) : 0.0);
    change_offsets(execution, offsets);
    execution.modal().length_number = OffsetNumber(number);
    execution.emit(UseToolLengthOffset{OffsetNumber(number), offsets.tool, offsets.follows_tip});
    const double radius =
        radius_of(execution, number) + (wider ? length_of(execution, *wider) : 0.0);
    const LengthUnit unit = execution.modal().unit;
    Parameters& parameters = execution.state.parameters.write();
    parameters.set_numbered(q_radius, from_mm(radius, unit));
    parameters.set_numbered(q_axis, static_cast<double>(normal));
    parameters.set_numbered(q_length_of_tool, from_mm(offsets.tool[normal], unit));
}

/// The length that the set-up gives a tool, where the program says another.
void warn_of_other_length(Execution& execution, int number, double length, const Word& word) {
    const auto known = length_under(*execution.state.tables, number);
    if (!known || std::abs(*known - length) < 1e-6) return;
    execution.warn(word.span,
                   fmt::format("{}: the tool table has the length {:.4f} mm for tool {}; "
                               "the program's counts",
                               written(word), *known, number));
}

} // namespace

core::Result<void> call_klartext_tool(Execution& execution) {
    const Statement& statement = execution.statement;
    if (const Word* tool = statement.word('T')) {
        FEELER_TRY(const int number, whole_number(*tool, 0, 32767));
        put_into_spindle(execution, ToolNumber(number));
        use_length(execution, number, *tool);
    } else if (const Word* longer = statement.word('L')) {
        if (!execution.modal().tool)
            return refuse_statement(execution, "no tool is in the spindle that DL could make "
                                               "longer");
        use_length(execution, value_of(*execution.modal().tool), *longer);
    }
    if (statement.word('F')) execution.state.klartext.write().call_feed = execution.modal().feed;
    return set_speed(execution);
}

core::Result<void> define_klartext_tool(Execution& execution) {
    const Statement& statement = execution.statement;
    const Word* tool = statement.word('T');
    if (!tool) return refuse_statement(execution, "the number of the tool is missing");
    FEELER_TRY(const int number, whole_number(*tool, 0, 32767));
    const Word* length = statement.word('L');
    const Word* radius = statement.word('R');
    if (!length && !radius) { // the next tool, to be brought near
        execution.modal().selected_tool = ToolNumber(number);
        execution.emit(SelectTool{ToolNumber(number)});
        return {};
    }
    if (length) warn_of_other_length(execution, number, length_of(execution, *length), *length);
    LengthOffset& entry = execution.state.tables.write().lengths[OffsetNumber(number)];
    if (length) entry.length = length_of(execution, *length);
    if (length) entry.wear = 0.0;
    if (radius) entry.diameter = 2.0 * length_of(execution, *radius);
    return {};
}

core::Result<void> read_system_datum(Execution& execution) {
    const Statement& statement = execution.statement;
    const auto number = [&](char letter) {
        const Word* word = statement.word(letter);
        return word ? std::lround(std::clamp(word->value, -1.0, 1e6)) : 0L;
    };
    const long group = number('I'), item = number('N'), index = number('K');
    const bool machine = group == 240, program = group == 270;
    if (!(machine || program) || item != 1 || index < 1 || index > long(axis_count))
        return core::fail(ErrorCode::unsupported,
                          fmt::format("FN 18: ID{} NR{} IDX{} is not known here: of the system's "
                                      "data the positions can be read, ID240 and ID270 NR1",
                                      group, item, index),
                          execution.block.command.span);
    const ModalState& modal = execution.modal();
    const Position place =
        machine ? machine_from_program(modal.offsets, modal.position) : modal.position;
    const auto axis = static_cast<size_t>(index - 1);
    if (!place[axis])
        execution.warn(execution.block.command.span,
                       fmt::format("FN 18: where the machine is along {} is not known, taken as 0; "
                                   "say where it starts",
                                   axis_letters[axis]));
    execution.state.parameters.write().set_numbered(static_cast<int>(statement.word('Q')->value),
                                                    place[axis].value_or(0.0));
    return {};
}

} // namespace gcode

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "gcode/siemens.h"

namespace gcode {
namespace {

using core::ErrorCode;
using core::OffsetNumber;
using core::ToolNumber;

/// The number of T="NAME": itself where it is one, else names are counted as they come.
int number_of_name(Execution& execution, const SiemensArgument& name) {
    int number = 0;
    const char* end = name.text.data() + name.text.size();
    const auto read = std::from_chars(name.text.data(), end, number);
    if (read.ec == std::errc() && read.ptr == end && number >= 0) return number;
    const auto& known = execution.state.siemens->tool_names;
    const auto found = std::find(known.begin(), known.end(), name.text);
    if (found != known.end()) return static_cast<int>(found - known.begin()) + 1;
    auto& names = execution.state.siemens.write().tool_names;
    names.emplace_back(name.text);
    number = static_cast<int>(names.size());
    execution.warn(name.span,
                   fmt::format("T=\"{}\" is tool {} here: names are counted as they come, and the "
                               "set-up has numbers",
                               name.text, number),
                   Severity::note);
    return number;
}

/// The length of the edge that is on counts along the axis of the plane's normal.
void use_length(Execution& execution, core::SourceSpan where) {
    ModalState& modal = execution.modal();
    const int edge = execution.state.siemens->edge;
    const int tool = modal.tool ? value_of(*modal.tool) : 0;
    Offsets offsets = modal.offsets;
    offsets.tool = {};
    std::optional<OffsetNumber> number;
    if (edge != 0 && tool != 0) {
        number = OffsetNumber(tool);
        const auto length = length_under(*execution.state.tables, tool);
        if (!length)
            execution.warn(where, fmt::format("D{}: nothing is known about the length of tool {}, "
                                              "taken as 0",
                                              edge, tool));
        else if (edge != 1)
            execution.warn(where, fmt::format("D{}: of tool {} one edge is known here, whose "
                                              "length is taken",
                                              edge, tool));
        offsets.tool[axes_of(modal.plane).normal] = length.value_or(0.0);
    }
    if (offsets == modal.offsets && modal.length_number == number) return;
    change_offsets(execution, offsets);
    modal.length_number = number;
    execution.emit(UseToolLengthOffset{number, offsets.tool, offsets.follows_tip});
}

void change(Execution& execution, core::SourceSpan where, bool stops_spindle) {
    ModalState& modal = execution.modal();
    modal.tool = modal.selected_tool;
    if (stops_spindle && modal.spindle != core::SpindleDirection::stopped)
        turn_siemens_spindle(execution, 5);
    const bool empty = *modal.tool == ToolNumber(0);
    execution.emit(ChangeTool{empty ? std::nullopt : modal.tool});
    // MD20270 as delivered: the first edge is on behind a change.
    const Word* edge = execution.statement.word('D');
    execution.state.siemens.write().edge = 1;
    if (!edge) use_length(execution, where);
}

core::Result<void> select(Execution& execution, int number, core::SourceSpan where) {
    execution.modal().selected_tool = ToolNumber(number);
    execution.column = where.column;
    execution.emit(SelectTool{ToolNumber(number)});
    if (execution.state.siemens->changes_with_t) change(execution, where, true);
    return {};
}

} // namespace

core::Result<void> use_siemens_tool(Execution& execution) {
    const SiemensArgument& name = execution.block.siemens.tool_name;
    if (const Word* word = execution.statement.word('T')) {
        FEELER_TRY(const int number, whole_number(*word, 0, 99999999));
        if (auto done = select(execution, number, word->span); !done) return done;
    } else if (name.kind == SiemensArgument::Kind::text) {
        if (auto done = select(execution, number_of_name(execution, name), name.span); !done)
            return done;
    }
    const CodeWord* entry = execution.statement.of(ModalGroup::tool_change);
    if (!entry) return {};
    execution.column = entry->word->span.column;
    if (!execution.modal().selected_tool)
        return core::fail(ErrorCode::missing_value,
                          "M6 has no tool to change to: no T word came before it",
                          entry->word->span);
    if (!execution.state.siemens->changes_with_m6)
        execution.state.siemens.write().changes_with_m6 = true;
    if (execution.state.siemens->changes_with_t) return {};
    change(execution, entry->word->span, true);
    return {};
}

core::Result<void> use_siemens_edge(Execution& execution) {
    const Word* word = execution.statement.word('D');
    if (!word) return {};
    FEELER_TRY(const int edge, whole_number(*word, 0, 32000));
    execution.column = word->span.column;
    const ModalState& modal = execution.modal();
    const SiemensState& siemens = *execution.state.siemens;
    // MD22550: where no M6 is said, the tool is changed with T.
    const bool with_t = edge > 0 && !siemens.changes_with_m6 && !siemens.changes_with_t
                        && modal.selected_tool && !modal.tool;
    if (with_t) {
        execution.warn(word->span,
                       "no M6 came before this D: the tool is taken as changed by T alone, as the "
                       "control's machine data may say",
                       Severity::note);
        execution.state.siemens.write().changes_with_t = true;
        change(execution, word->span, false);
    }
    execution.state.siemens.write().edge = edge;
    use_length(execution, word->span);
    return {};
}

core::Result<void> set_siemens_radius(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::cutter_radius);
    if (!entry && execution.modal().compensation == Side::none) return {};
    // D is an edge of the tool here, and no number of an offset.
    Statement without = execution.statement;
    without.words['D' - 'A'] = nullptr;
    Execution shared{execution.library, execution.environment, execution.dialect, execution.block,
                     without,           execution.state,       execution.result,  execution.column};
    if (auto done = set_cutter_radius(shared); !done) return done;
    if (!entry || execution.modal().compensation == Side::none) return {};
    if (execution.state.siemens->edge == 0)
        execution.warn(entry->word->span,
                       fmt::format("{}: D0 is on, so the control has no radius to compensate; that "
                                   "of the tool is taken",
                                   written(*entry->word)));
    const core::Mat3& linear = execution.state.siemens->frame.linear;
    const auto first = static_cast<int>(axes_of(execution.modal().plane).first);
    const double stretch = glm::length(linear[first]);
    execution.modal().compensation_radius /= stretch;
    return {};
}

} // namespace gcode

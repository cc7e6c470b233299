#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/math.h"
#include "gcode/exec/loop_detector.h"
#include "gcode/exec/readings.h"
#include "gcode/klartext/klartext.h"
#include "gcode/language/flow_index.h"

namespace gcode {
namespace {

core::Result<std::string> label_name(const FlowStep& step) {
    const Flow& flow = step.block.flow;
    if (flow.has_label) return step.block.pool.names[flow.label_name];
    note_computed_target(step.state);
    const ProgramParameters parameters(step.state, step.environment);
    FEELER_TRY(const Value value, evaluate(step.block.pool, flow.label, step.block.line, parameters,
                                           step.dialect.arithmetic));
    return label_of(core::round(value.value_or(0.0)));
}

core::Result<uint32_t> line_of_label(const FlowStep& step) {
    FEELER_TRY(const std::string name, label_name(step));
    if (name != "0")
        if (const FlowMark* mark =
                step.library.index(step.state.next.source).first(FlowKind::label, name))
            return mark->line;
    return refuse_step(step, fmt::format("there is no LBL {} in this program", name));
}

/// Whether the current call level was started by `CALL LBL`. Such a level stays in the program of
/// its caller, one of `CALL PGM` does not.
bool is_label_call(const InterpreterState& state) {
    const Frame& frame = state.frames.back();
    return state.frames.size() > 1 && frame.begin.source == frame.called_from.source;
}

/// LBL 0 ends a called subprogram. Without a call it has no effect.
core::Result<void> pass_label(const FlowStep& step) {
    FEELER_TRY(const std::string name, label_name(step));
    if (name == "0" && is_label_call(step.state)) leave(step.state);
    return {};
}

/// `CALL LBL 1 REP 5`: repeats the program part from the label to here five more times.
core::Result<void> repeat_part(const FlowStep& step, uint32_t label) {
    const ProgramParameters parameters(step.state, step.environment);
    FEELER_TRY(const Value count, evaluate(step.block.pool, step.block.flow.condition,
                                           step.block.line, parameters, step.dialect.arithmetic));
    report_unknown(parameters, step.result, step.block.flow.span, "the number of repetitions");
    auto& repeats = step.state.frames.back().repeats;
    const auto rounds = static_cast<int64_t>(std::clamp(count.value_or(0.0), 0.0, 1e15));
    const auto [entry, begins] = repeats.try_emplace(step.block.line, rounds);
    if (begins)
        note_condition(step.state, step.block.line, step.block.pool, step.block.flow.condition, {},
                       static_cast<double>(rounds), step.dialect);
    int64_t& left = entry->second;
    if (left > 0) {
        --left;
        note_repetitions(step.state, {step.state.next.source, step.block.line}, left);
        step.state.next.line = label;
    } else {
        repeats.erase(step.block.line);
    }
    return {};
}

core::Result<void> call_label(const FlowStep& step) {
    FEELER_TRY(const uint32_t line, line_of_label(step));
    if (step.block.flow.has_condition) return repeat_part(step, line);
    const uint32_t source = step.state.next.source;
    Frame next{.called_from = {source, step.block.line},
               .begin = {source, line + 1},
               .name = step.block.pool.names.empty() ? "" : step.block.pool.names[0]};
    return enter(step.state, step.environment, std::move(next), step.block.flow.span);
}

/// Only the file name of the path is used: files come from the search path.
core::Result<void> call_program(const FlowStep& step) {
    const std::string& path = step.block.pool.names[step.block.flow.label_name];
    const std::string name = path.substr(path.find_last_of("\\/:") + 1);
    FEELER_TRY(const auto source, step.library.find({name, name + ".h", name + ".H"}));
    if (!source)
        return refuse_step(
            step, fmt::format("CALL PGM {}: there is no file {} in the search path", path, name));
    Frame next{.called_from = {step.state.next.source, step.block.line},
               .begin = {*source, 1},
               .name = name};
    return enter(step.state, step.environment, std::move(next), step.block.flow.span);
}

core::Result<void> end_program(const FlowStep& step) {
    if (is_label_call(step.state))
        return refuse_step(
            step,
            fmt::format("END PGM inside the subprogram called in line {}: its LBL 0 is missing",
                        step.state.frames.back().called_from.line));
    if (step.state.frames.size() > 1) {
        leave(step.state);
        return {};
    }
    step.state.ending = ProgramStatus::program_end;
    step.result.commands.push_back(ProgramEnd{});
    step.result.columns.push_back(step.block.flow.span.column);
    return {};
}

} // namespace

core::Result<void> run_klartext_flow(const FlowStep& step) {
    switch (step.block.flow.kind) {
    case FlowKind::label:
        return pass_label(step);
    case FlowKind::call_label:
        return call_label(step);
    case FlowKind::call_program:
        return call_program(step);
    case FlowKind::end_program:
        return end_program(step);
    default:
        break;
    }
    const ProgramParameters parameters(step.state, step.environment);
    FEELER_TRY(const bool goes, condition_holds(step.state, step.block, parameters, step.dialect));
    if (!goes) return {};
    FEELER_TRY(step.state.next.line, line_of_label(step));
    return {};
}

} // namespace gcode

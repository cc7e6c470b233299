#include "gcode/exec/flow.h"

#include <fmt/format.h>

#include "gcode/exec/loop_detector.h"
#include "gcode/exec/modes.h"
#include "gcode/exec/readings.h"
#include "gcode/language/flow_index.h"
#include "gcode/language/language.h"

namespace gcode {

using core::ErrorCode;

core::Result<void> run_flow(const FlowStep& step) {
    return functions_of(step.dialect.language).run_flow(step);
}

core::Result<bool> condition_holds(InterpreterState& state, const Block& block,
                                   const ProgramParameters& parameters, const Dialect& dialect) {
    Margins margins;
    parameters.forget_reads();
    FEELER_TRY(const Value value, evaluate(block.pool, block.flow.condition, block.line, parameters,
                                           dialect.arithmetic, &margins));
    note_condition(state, block.line, block.pool, block.flow.condition, margins, value, dialect);
    return outcome_of(parameters, block, block.flow.condition, dialect.arithmetic,
                      value.value_or(0.0) != 0.0);
}

std::optional<uint32_t> line_of_block(ProgramLibrary& library, uint32_t source, double number,
                                      uint32_t from) {
    const FlowIndex& index = library.index(source);
    uint32_t begin = 1, end = UINT32_MAX;
    for (const FlowMark& mark : index.marks) {
        if (mark.kind != FlowKind::program_number) continue;
        if (mark.line <= from) begin = mark.line;
        if (mark.line > from && end == UINT32_MAX) end = mark.line;
    }
    if (const auto ahead = index.line_of_number(number, from + 1, end)) return ahead;
    return index.line_of_number(number, begin, from + 1);
}

core::Result<void> enter(InterpreterState& state, const Environment& environment, Frame frame,
                         core::SourceSpan where) {
    const size_t own = dialect(environment.dialect).deepest_calls;
    const size_t deepest = environment.limits.calls ? environment.limits.calls : own;
    if (state.frames.size() > deepest)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("calls are nested deeper than the {} levels this control "
                                      "allows: check whether a subprogram calls itself endlessly",
                                      deepest),
                          where);
    state.next = frame.begin;
    if (!frame.shares_locals) note_new_locals(state);
    state.frames.push_back(std::move(frame));
    return {};
}

void leave(InterpreterState& state) {
    Frame& frame = state.frames.back();
    if (frame.rounds_left > 0) {
        if (frame.restore) frame.restore(state, frame);
        --frame.rounds_left;
        note_repetitions(state, frame.called_from, frame.rounds_left);
        frame.repeats.clear();
        frame.repeated.clear();
        if (frame.again) {
            frame.locals = frame.again->values;
            frame.unpredictable_locals = frame.again->unpredictable;
            frame.unknown = frame.again->unknown;
        }
        state.next = frame.begin;
        return;
    }
    leave_to(state, frame.called_from.line + 1);
}

void leave_to(InterpreterState& state, uint32_t line) {
    Frame& frame = state.frames.back();
    if (frame.restores && *frame.saved) restore_modes(state, **frame.saved);
    if (frame.restore) frame.restore(state, frame);
    // Fanuc B-64304, modal call: local variables keep their values between the calls.
    if (frame.modal_macro > 0 && frame.modal_macro <= state.modal_macros.size()) {
        ModalMacro& macro = state.modal_macros[frame.modal_macro - 1];
        macro.arguments = frame.locals;
        macro.unpredictable = frame.unpredictable_locals;
        macro.unknown = std::move(frame.unknown);
    }
    state.next = {frame.called_from.source, line};
    state.frames.pop_back();
}

} // namespace gcode

#include <fmt/format.h>

#include "gcode/flow.h"
#include "gcode/modes.h"

namespace gcode {

using core::ErrorCode;

core::Result<void> enter(InterpreterState& state, const Environment& environment, Frame frame,
                         core::SourceSpan where) {
    const size_t own = dialect(environment.dialect).deepest_calls;
    const size_t deepest = environment.limits.calls ? environment.limits.calls : own;
    if (state.frames.size() > deepest)
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("calls go deeper than the {} levels this control has: does "
                                      "a subprogram call itself without end?",
                                      deepest),
                          where);
    state.next = frame.begin;
    state.frames.push_back(std::move(frame));
    return {};
}

void leave(InterpreterState& state) {
    Frame& frame = state.frames.back();
    if (frame.rounds_left > 0) {
        --frame.rounds_left;
        frame.repeats.clear();
        if (frame.again) frame.locals = *frame.again;
        state.next = frame.begin;
        return;
    }
    leave_to(state, frame.called_from.line + 1);
}

void leave_to(InterpreterState& state, uint32_t line) {
    Frame& frame = state.frames.back();
    if (frame.restores && *frame.saved) restore_modes(state, **frame.saved);
    // Fanuc B-64304, modal call: the local variables are not set anew for each call.
    if (frame.modal_macro > 0 && frame.modal_macro <= state.modal_macros.size())
        state.modal_macros[frame.modal_macro - 1].arguments = frame.locals;
    state.next = {frame.called_from.source, line};
    state.frames.pop_back();
}

} // namespace gcode

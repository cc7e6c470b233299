#include "gcode/flow.h"

namespace gcode {

using core::ErrorCode;

core::Result<void> watch_for_endless_loop(InterpreterState& state, Place from) {
    constexpr uint64_t interval = 16; // jumps between two looks
    const bool back = state.next.source != from.source || state.next.line <= from.line;
    LoopWatch& watch = state.watch;
    if (!back || ++watch.jumps % interval != 0) return {};
    const uint64_t now = digest_of(state);
    if (now == watch.noted && watch.next_note > 1)
        return core::fail(ErrorCode::invalid_value,
                          "the program never ends: it comes back here in exactly the same state, "
                          "so it will do so again",
                          {.line = from.line, .column = 1});
    if (watch.jumps / interval < watch.next_note) return {};
    watch.noted = now;
    watch.next_note *= 2;
    return {};
}

} // namespace gcode

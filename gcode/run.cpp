#include "gcode/interpreter.h"

namespace gcode {

std::optional<Warning> ending_warning(const Environment& environment,
                                      const InterpreterState& state) {
    const core::SourceSpan where{.line = static_cast<uint32_t>(state.next.line - 1)};
    if (state.ending == Ending::main_return)
        return Warning{Severity::warning, where,
                       "M99 in a main program starts it again; one pass was looked at"};
    const bool proper_mark =
        state.ending == Ending::tape_mark && dialect(environment.dialect).tape_mark_ends_program;
    if (state.ending == Ending::text_end || (state.ending == Ending::tape_mark && !proper_mark))
        return Warning{Severity::warning, where, "the program has no M2 or M30 at its end"};
    return std::nullopt;
}

Run run(const Program& program, const Environment& environment) {
    Run whole;
    whole.library = std::make_shared<ProgramLibrary>(program, dialect(environment.dialect),
                                                     environment.search_path);
    Interpreter interpreter(*whole.library, environment);
    whole.state = initial_state(environment);
    while (true) {
        auto result = interpreter.next(whole.state);
        if (!result) {
            whole.error = std::move(result).error();
            return whole;
        }
        if (!*result) break;
        whole.blocks.push_back(**result);
    }
    whole.ending = ending_warning(environment, whole.state);
    return whole;
}

} // namespace gcode

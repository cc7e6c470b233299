#include "gcode/exec/startup.h"

#include <algorithm>

#include "gcode/exec/interpreter.h"
#include "gcode/exec/subprogram.h"
#include "gcode/language/environment.h"
#include "gcode/text/source.h"

namespace gcode {

core::Result<void> run_startup_code(InterpreterState& state, const Environment& environment) {
    if (environment.startup_code.empty()) return {};
    constexpr const char* name = "the start-up code";
    FEELER_TRY(const Program program, program_from_text(environment.startup_code, name));
    ProgramLibrary library(program, dialect(environment.dialect), environment.search_path);
    Interpreter interpreter(library, environment);
    InterpreterState run = state;
    while (true) {
        const auto block = interpreter.next(run);
        if (!block) return tl::unexpected(block.error());
        if (!*block) break;
        const auto acts = [](const CanonicalCommand& command) {
            return is_motion(command) || std::holds_alternative<ChangeTool>(command);
        };
        const auto& commands = (*block)->commands;
        if (std::any_of(commands.begin(), commands.end(), acts))
            return tl::unexpected(core::Error{
                core::ErrorCode::unsupported,
                {.line = (*block)->line},
                "start-up code that moves the machine or changes the tool is not supported",
                name});
    }
    state.modal = run.modal;
    state.parameters = run.parameters;
    state.tables = run.tables;
    return {};
}

} // namespace gcode

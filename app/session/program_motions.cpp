#include "app/session/program_motions.h"

#include "gcode/lowering.h"

namespace app {

void visit_events(const gcode::Program& program, const gcode::Environment& environment,
                  const std::function<void(const ProgramEvent&)>& visit) {
    gcode::ProgramLibrary library(program, gcode::dialect(environment.dialect),
                                  environment.search_path);
    gcode::Interpreter interpreter(library, environment);
    gcode::InterpreterState state = gcode::initial_state(environment);
    gcode::Lowering lowering = gcode::initial_lowering(environment);
    std::optional<core::ToolNumber> tool;
    while (true) {
        const auto block = interpreter.next(state);
        if (!block || !*block) return;
        for (const core::Event& event : gcode::lower(**block, lowering)) {
            if (const auto* change = std::get_if<core::ToolChange>(&event)) tool = change->tool;
            visit({event, tool, lowering.offsets, (*block)->line, (*block)->is_cycle});
        }
    }
}

} // namespace app

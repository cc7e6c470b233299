#include "app/viewer/early_track.h"

#include "app/session/prepared_check.h"

namespace app::viewer {
namespace {

void follow(const PreparedCheck& check, ProgramTrack& track,
            const std::function<bool()>& is_closing) {
    const gcode::Environment& environment = check.file.environment;
    gcode::ProgramLibrary library(*check.program, gcode::dialect(environment.dialect),
                                  environment.search_path);
    gcode::Interpreter interpreter(library, environment);
    gcode::InterpreterState state = gcode::initial_state(environment);
    gcode::Lowering lowering = gcode::initial_lowering(environment);
    while (track.rows.size() < most_early_blocks && !is_closing()) {
        const auto block = interpreter.next(state);
        if (!block || !*block) return;
        track.add(**block, gcode::lower(**block, lowering));
    }
}

} // namespace

core::Result<EarlyTrack> early_track(const CheckJob& job, const std::function<bool()>& is_closing) {
    FEELER_TRY(const PreparedCheck check, read_check(job));
    OpenedProgram opened;
    opened.program = job.program;
    opened.setup = job.setup;
    opened.dialect = gcode::dialect(check.run.dialect).name;
    opened.assumptions = check.run.assumptions;
    opened.is_inferred = job.setup.empty();
    opened.scene = make_scene_setup(check.run.setup);
    EarlyTrack early{ProgramTrack(opened.scene->setup), nullptr};
    follow(check, early.track, is_closing);
    early.opened = std::make_shared<const OpenedProgram>(std::move(opened));
    return early;
}

} // namespace app::viewer

#include "app/setup/control/used_offsets.h"

#include <algorithm>

#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"

namespace app {
namespace {

/// Whether a number of the table of tool offsets has the values from before the program.
bool is_unchanged(const gcode::InterpreterState& state, const gcode::Environment& environment,
                  core::OffsetNumber number) {
    const auto now = state.tables->lengths.find(number);
    const auto before = environment.length_offsets.find(number);
    if (before == environment.length_offsets.end()) return now == state.tables->lengths.end();
    return now != state.tables->lengths.end() && now->second == before->second;
}

bool moves_in_work(const gcode::BlockCommands& block) {
    return !block.in_machine && !block.goes_home
           && std::any_of(block.commands.begin(), block.commands.end(), gcode::is_motion);
}

void add_block(const gcode::BlockCommands& block, const gcode::InterpreterState& state,
               const gcode::Environment& environment, UsedOffsets& used) {
    const gcode::ModalState& modal = state.modal;
    if (modal.length_sign != 0.0 && modal.length_number
        && is_unchanged(state, environment, *modal.length_number))
        used.lengths.insert(*modal.length_number);
    const core::OffsetNumber radius{modal.radius_number};
    if (modal.compensation != gcode::Side::none && modal.radius_number > 0
        && is_unchanged(state, environment, radius))
        used.diameters.insert(radius);
    const size_t active = modal.offsets.active;
    if (moves_in_work(block) && active < gcode::no_work_offset
        && gcode::work_offset(*state.tables, active).origin == environment.work_offset(active))
        used.work.insert(active);
}

} // namespace

UsedOffsets used_offsets(const gcode::Program& program, const gcode::Environment& environment) {
    gcode::ProgramLibrary library(program, gcode::dialect(environment.dialect),
                                  environment.search_path);
    gcode::Interpreter interpreter(library, environment);
    gcode::InterpreterState state = gcode::initial_state(environment);
    UsedOffsets used;
    while (true) {
        const auto block = interpreter.next(state);
        if (!block) used.stopped = block.error();
        if (!block || !*block) return used;
        add_block(**block, state, environment, used);
    }
}

} // namespace app

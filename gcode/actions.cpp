#include <fmt/format.h>

#include "gcode/cycles.h"
#include "gcode/execution.h"

namespace gcode {
core::Result<void> act(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::action);
    if (!entry) return {};
    switch (entry->code->tenths) {
    case tenths(10):
        return write_offset(execution);
    case tenths(12):
    case tenths(13):
        return mill_circular_pocket(execution);
    case tenths(27):
        return check_home(execution);
    case tenths(29):
        return return_from_home(execution);
    case tenths(31):
        return skip_move(execution);
    case tenths(70):
    case tenths(71):
    case tenths(72):
        return run_hole_pattern(execution);
    case tenths(28):
    case tenths(30):
        return go_home(execution);
    case tenths(28, 1):
    case tenths(30, 1):
        return store_home(execution);
    case tenths(52):
        return set_local_offset(execution);
    case tenths(92):
    case tenths(92, 1):
    case tenths(92, 2):
    case tenths(92, 3):
        return set_axis_offset(execution);
    default:
        return {}; // G4 and G53 have steps of their own
    }
}

core::Result<void> stop(Execution& execution) {
    const CodeWord* entry = execution.statement.of(ModalGroup::stopping);
    if (!entry) return {};
    switch (entry->code->tenths) {
    case tenths(1):
        execution.emit(OptionalStop{});
        break;
    case tenths(2):
    case tenths(30):
        execution.state.ending = Ending::program_end;
        execution.emit(ProgramEnd{});
        break;
    default:
        execution.emit(ProgramStop{});
        break; // M0, M60
    }
    return {};
}

} // namespace gcode

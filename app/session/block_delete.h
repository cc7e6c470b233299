#pragma once

#include "app/session/check_run.h"

namespace app {

/// Looks whether the machine moves otherwise when the switch for blocks with `/` is on, if the run
/// has a note that there are such blocks. If so, the note gets the severity of its rule.
void look_at_both_switch_positions(CheckRun& run, const gcode::Program& program,
                                   const gcode::Environment& environment);

} // namespace app

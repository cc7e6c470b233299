#pragma once

#include <vector>

#include "core/sim/setup.h"
#include "gcode/lowering.h"

namespace app {

/// What a block does to the machine, in order: fixtures that the set-up moves before it, then what
/// the program says.
///
/// `speed_by_hand`: a spindle that is started turns, whatever speed the program states.
std::vector<core::Event> events_of(const core::Setup& setup, const gcode::BlockResult& block,
                                   gcode::Lowering& lowering, bool speed_by_hand);

} // namespace app

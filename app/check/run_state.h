#pragma once

#include <set>

#include "app/check/length_mismatch.h"
#include "app/check/offset_watch.h"
#include "core/sim/run/block_clock.h"
#include "core/sim/run/simulator.h"
#include "gcode/exec/interpreter.h"
#include "gcode/lower/lowering.h"

namespace app {

/// Everything between two blocks of a run: the control, the machine, the stock, and what rules keep
/// in mind. A plain value: copy it to come back; copies share what is large.
struct RunState {
    gcode::InterpreterState control;
    gcode::Lowering lowering;
    core::SimulatorState machine;
    core::BlockClock clock;
    LengthWatch lengths = {};
    OffsetWatch offsets = {};
    UnitsWatch units = {};
    std::set<size_t> moves_made = {}; // of the set-up's fixture moves
};

/// Before the first block, where the machine stands so.
RunState start_of_program(const gcode::Environment& environment, const core::Setup& setup,
                          core::SimulatorState machine);

/// A number that follows from all that decides how a run goes on and what it looks like here: the
/// control, every scan line with what cut it, the places of axes, tool, spindle and fixtures.
///
/// Cost: reads every line of the stock.
uint64_t digest_of(const RunState& place);

} // namespace app

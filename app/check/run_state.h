#pragma once

#include <set>

#include "app/check/feed_use.h"
#include "app/check/length_mismatch.h"
#include "core/sim/run/block_clock.h"
#include "core/sim/run/simulator.h"
#include "gcode/exec/interpreter.h"
#include "gcode/lower/lowering.h"

namespace core {
struct Setup;
}
namespace gcode {
struct Environment;
}

namespace app {

/// The complete state between two blocks of a run: control, machine, stock and rules. A plain
/// value: keep a copy to return to it; copies share large data.
struct RunState {
    gcode::InterpreterState control;
    gcode::Lowering lowering;
    core::SimulatorState machine;
    core::BlockClock clock;
    LengthTracker lengths = {};
    OffsetUses offsets = {};
    FeedFacts feeds = {};
    std::set<size_t> moves_made = {}; // indices of the set-up's fixture moves
    bool said_displaced = false;      // that an axis that nobody described is away from 0
};

/// The state before the first block, with the given simulator state.
RunState start_of_program(const gcode::Environment& environment, const core::Setup& setup,
                          core::SimulatorState machine);

/// A hash of everything that determines how the run continues and what it shows: the control, every
/// scan line and the moves that cut it, axis positions, tool, spindle and fixtures.
///
/// Cost: reads every scan line of the stock.
uint64_t digest_of(const RunState& state);

} // namespace app

#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/sim/finding.h"

namespace core {
struct BlockEvents;
struct Setup;
struct SimulatorState;
} // namespace core
namespace gcode {
struct InterpreterState;
}

namespace app {

/// The heights of a program's feeds relative to the stock in one work offset.
struct OffsetUse {
    std::optional<core::BlockIndex> above_block, below_block; // the first with such a feed
    double way = 0.0;                // feed travel within the stock's outline in XY, mm
    double above = 0.0, below = 0.0; // of this, above and below the stock, mm
    double lowest = core::infinity,
           highest = -core::infinity;           // Z of these feeds relative to the datum, mm
    double stock_bottom = 0.0, stock_top = 0.0; // relative to the datum, mm
    double under = core::infinity; // least distance of feeds below the stock from its bottom
    bool rapids_through = false;   // a rapid crosses the stock's height range, not upwards
    bool is_judged = true;         // false: the tool was tilted
};

/// The uses of all work offsets so far, by index; 0 is G54. A plain value.
using OffsetUses = std::map<size_t, OffsetUse>;

/// Updates the watch after a block; `state` is the state after it.
void track_offsets(OffsetUses& uses, const core::Setup& setup, const gcode::InterpreterState& at,
                   const core::BlockEvents& block, const core::SimulatorState& state);

/// The findings `offset-implausible`: work offsets in which nearly all feeds are above the stock,
/// or below it by more than cutting through needs or together with rapids at its height. The datum
/// was probably set elsewhere.
std::vector<core::Finding> implausible_offsets(const OffsetUses& uses, const core::Setup& setup);

/// The box around all feed moves. A plain value.
struct UnitsTracker {
    core::Aabb box;
    std::optional<core::BlockIndex> first;
};

/// Updates the box with a block.
void track_units(UnitsTracker& tracker, const core::BlockEvents& block);

/// The finding `units-jump`: the feeds span about 25.4 times the stock or, if the program states no
/// unit, 1/25.4 of it.
std::optional<core::Finding> unit_mismatch(const UnitsTracker& tracker, const core::Setup& setup,
                                           const core::Aabb& stock, bool unit_said);

} // namespace app

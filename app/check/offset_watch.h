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
    double way = 0.0;                // mm of feed within the stock's outline in XY
    double above = 0.0, below = 0.0; // mm of these above or below the stock
    double lowest = core::infinity, highest = -core::infinity; // of these feeds, from the datum
    double stock_bottom = 0.0, stock_top = 0.0;                // likewise
    double under = core::infinity; // least distance of those below to the stock's bottom
    bool rapids_through = false;   // a rapid crosses or goes down at the stock's height
    bool is_judged = true;         // false: the tool was tilted
};

/// The uses of all work offsets so far, by index; 0 is G54. A plain value.
using OffsetWatch = std::map<size_t, OffsetUse>;

/// Takes a block into account; `state` is that after the block.
void watch_offsets(OffsetWatch& watch, const core::Setup& setup, const gcode::InterpreterState& at,
                   const core::BlockEvents& block, const core::SimulatorState& state);

/// The findings `offset-implausible`: work offsets in which nearly all feeds are above the stock,
/// or below it by more than a cut through it needs or with rapids at its height. The datum was
/// probably set elsewhere.
std::vector<core::Finding> implausible_offsets(const OffsetWatch& watch, const core::Setup& setup);

/// The box around all feed moves. A plain value.
struct UnitsWatch {
    core::Aabb box;
    std::optional<core::BlockIndex> first;
};

/// Takes a block into account.
void watch_units(UnitsWatch& watch, const core::BlockEvents& block);

/// The finding `units-jump`: the feeds span about 25.4 times the stock or, if the program states no
/// unit, 1/25.4 of it.
std::optional<core::Finding> units_off_the_stock(const UnitsWatch& watch, const core::Setup& setup,
                                                 const core::Aabb& stock, bool unit_said);

} // namespace app

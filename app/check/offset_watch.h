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

/// How high the feeds of a program stand against the stock, under one of its work offsets.
struct OffsetUse {
    std::optional<core::BlockIndex> above_block, below_block; // the first that feeds there
    double way = 0.0;                // mm that the tip feeds over or under the stock
    double above = 0.0, below = 0.0; // of it, where it is above the stock or below it
    double lowest = core::infinity, highest = -core::infinity; // of these feeds, from the datum
    double stock_bottom = 0.0, stock_top = 0.0;                // likewise
    double under = core::infinity; // by how much these below are at least below the stock
    bool rapids_through = false;   // rapids go across at the stock's height or down to it
    bool is_judged = true;         // false: the tool leaned
};

/// What is known of every work offset so far. A plain value.
using OffsetWatch = std::map<size_t, OffsetUse>;

/// Takes a block into account. `before` and `after` are the machine's state round it.
void watch_offsets(OffsetWatch& watch, const core::Setup& setup, const gcode::InterpreterState& at,
                   const core::BlockEvents& block, const core::SimulatorState& state);

/// The findings `offset-implausible`: work offsets under which all but some of the feeds lie above
/// the stock, or below it, more than any cut through it does or with rapids at its height, as if
/// its datum was set elsewhere.
std::vector<core::Finding> implausible_offsets(const OffsetWatch& watch, const core::Setup& setup);

/// The box that the tip's feeds span. A plain value.
struct UnitsWatch {
    core::Aabb box;
    std::optional<core::BlockIndex> first;
};

/// Takes a block into account.
void watch_units(UnitsWatch& watch, const core::BlockEvents& block);

/// The finding `units-jump` about a program whose feeds span 25.4 times the stock or, where it does
/// not say a unit, as small a part of it.
std::optional<core::Finding> units_off_the_stock(const UnitsWatch& watch, const core::Setup& setup,
                                                 const core::Aabb& stock, bool unit_said);

} // namespace app

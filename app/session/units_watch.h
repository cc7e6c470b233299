#pragma once

#include <optional>

#include "core/sim/simulator.h"

namespace app {

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

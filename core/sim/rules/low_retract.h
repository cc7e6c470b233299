#pragma once

#include <optional>

#include "core/sim/leg/leg_check.h"

namespace core {

/// A rapid between two features, as it ran, with what a second look needs.
struct LinkRapid {
    const Setup& setup;
    const ToolAssembly& tool;
    BlockIndex block;
    const Leg& leg;
    const std::vector<bool>& fixtures_there;
    const CutModel& stock; // before the rapid
};

/// Whether a leg goes across far enough to be a way from one feature to another.
bool goes_across(const Leg& leg);

/// The finding `low-retract`: the tool is free where the rapid begins and where it ends, but not of
/// what stands between, or passes over it by less than half a millimetre. `pairs` are what was
/// found on the leg. Its severity is left open.
///
/// Cost: nothing where the rapid passes well clear; else some twenty checks of the leg.
std::optional<Finding> low_retract(const LinkRapid& link, const std::vector<PairClearance>& known);

} // namespace core

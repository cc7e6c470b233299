#pragma once

#include <optional>

#include "core/motion/event.h"
#include "core/motion/machine.h"
#include "core/sim/finding.h"

namespace core {

/// The finding `singular-orientation` about a feed on which rotary axes turn: near the pole, where
/// an axis turns far while the tool hardly leans and its tip hardly moves; or, where the control
/// does not follow the tip, a block of several rotary axes that is so long that the tip swings off
/// its line by more than 0.5 mm. Severity and block are left open.
std::optional<Finding> singular_orientation(const Machine& machine, const Motion& motion,
                                            double tool_length);

} // namespace core

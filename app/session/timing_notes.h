#pragma once

#include <string>
#include <vector>

#include "core/sim/machine.h"

namespace app {

/// What the times of a run take for granted on this machine, for its assumptions.
std::vector<std::string> timing_notes(const core::Machine& machine);

} // namespace app

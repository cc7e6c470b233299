#pragma once

#include "core/sim/simulator.h"

namespace core {

/// The finding for a pair that did not keep its allowance in a block, with its cure.
Finding finding_of(const Setup& setup, const PairClearance& pair, BlockMotion motion,
                   const SimulatorState& state, double duration);

/// The severity of a rule in this set-up.
Severity severity_of(const Setup& setup, const std::string& rule);

} // namespace core

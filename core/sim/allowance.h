#pragma once

#include "core/sim/setup.h"

namespace core {

struct Pair;

/// What a pair must keep: a distance, and how much overlap is contact when the distance is 0.
struct Allowance {
    double distance = 0.0;
    double contact = 0.0;
};

/// What a pair must keep, by the set-up's rules or else by default.
Allowance allowance_of(const Setup& setup, const Pair& pair);

} // namespace core

#pragma once

#include "core/sim/setup.h"

namespace core {

/// What a pair must keep: a distance, and how much overlap is contact when the distance is 0.
struct Allowance {
    double distance = 0.0;
    double contact = 0.0;
};

/// What the pair of a tool's part and the stock must keep.
Allowance stock_allowance(const Setup& setup, PartKind part);

/// What the pair of a tool's part and a fixture must keep.
Allowance fixture_allowance(const Setup& setup, PartKind part, const Fixture& fixture);

} // namespace core

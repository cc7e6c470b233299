#pragma once

#include "core/dbm/cutter.h"

namespace core {

/// The box of what a sweep can remove from a stock, out of which the cutter standing at `from` has
/// been taken already; `top` is above all stock.
///
/// Proof: a point that the cutter comes to hold, and did not hold at `from`, lies on the way of a
/// point of its surface where the surface faces the motion. The box is that of those points and
/// their way.
Aabb front_bounds(const CutterSweep& sweep, double top);

} // namespace core

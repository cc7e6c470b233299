#pragma once

#include "tests/bench/contestant.h"

namespace bench {

/// The Flexible Collision Library: each point is a degenerate triangle, bounding volumes OBBRSS.
Contestant fcl_peer();

/// A KD-tree over A; each point of B queries it for a point nearer than the best so far.
Contestant nanoflann_peer();

/// A hierarchy over A in floats; each point of B queries it for a point nearer than the best so
/// far.
Contestant embree_peer();

} // namespace bench

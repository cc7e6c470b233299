#pragma once

#include "core/base/vec.h"
#include "core/distance/closest_pair.h"
#include "core/distance/point_tree.h"

namespace core {

/// Finds the closest pair of points with boxes in a frame aligned to the best pair so far, eight at
/// a time.
///
/// Frame:   the result is in that of A.
/// Result:  the same distance as brute force, to the last bit, unless the goal asks for less; the
///          same pair and counts on every processor.
ClosestPair closest_pair(const PointTree& a, const PointTree& b, const Transform& a_from_b,
                         const PairGoal& goal = {});

} // namespace core

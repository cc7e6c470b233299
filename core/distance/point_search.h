#pragma once

#include "core/base/transform.h"
#include "core/distance/closest_pair.h"
#include "core/distance/point_tree.h"
#include "core/distance/search_memory.h"

namespace core {

/// Finds the closest pair of points by boxes in the frame of the best pair so far, eight at a time.
///
/// Frame:  the result is in that of A.
/// Result: the same distance as brute force, to the last bit, unless the goal asks for less; the
///         same pair and counts on every processor.
ClosestPair closest_pair(const PointTreeView& a, const PointTreeView& b, const Transform& a_from_b,
                         const PairGoal& goal = {});

/// The same, of bodies that were searched before with this memory and have not changed since; for
/// poses near the last one it is several times as fast.
ClosestPair closest_pair(const PointTreeView& a, const PointTreeView& b, const Transform& a_from_b,
                         const PairGoal& goal, SearchMemory& memory);

inline ClosestPair closest_pair(const PointTree& a, const PointTree& b, const Transform& a_from_b,
                                const PairGoal& goal = {}) {
    return closest_pair(PointTreeView{&a, {}}, PointTreeView{&b, {}}, a_from_b, goal);
}

} // namespace core

#pragma once

#include "core/base/transform.h"
#include "core/distance/closest_pair.h"
#include "core/distance/sphere_tree.h"

namespace core {

/// Finds the closest pair of points by the paper's search.
///
/// Frame:  the result is in that of A.
/// Result: the least distance over all pairs, to the last bit, unless the goal asks for less; of
///         equally near pairs the first that the search meets, which depends on nothing but the
///         input. Coinciding points end the search.
/// Cost:   a few thousand sphere tests for bodies apart; up to all pairs where faces lie parallel.
/// Source: Uddin, Yamazaki, Study of Distance Computation between Objects Represented by Discrete
///         Boundary Model, 2010, 4.2.2. Limit, tolerance, sweep and first pair are ours.
ClosestPair closest_pair(const SphereTree& a, const SphereTree& b, const Transform& a_from_b,
                         const PairGoal& goal = {});

} // namespace core

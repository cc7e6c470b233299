#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/base/vec.h"
#include "core/distance/closest_pair.h"

namespace core {

/// The tree of the paper over the points of a body: each node has a sphere around the centre of the
/// box of its points; a leaf is one point.
struct SphereTree {
    struct Node {
        Vec3 centre = Vec3(0.0);
        double radius = 0.0;
        uint32_t right = 0; // the left child is the next node; 0 marks a leaf
        uint32_t point = 0; // of a leaf: its index in the input

        bool is_leaf() const { return right == 0; }
    };

    std::vector<Node> nodes;             // depth first, the root first; 2 n - 1 nodes for n points
    std::vector<uint32_t> leaf_of_point; // node of each input point
};

/// Builds the tree. Each node is split at the median along the longest side of its box, equal
/// coordinates by index.
///
/// Errors:  no point; a coordinate that is not finite or beyond 1e12 mm; more than 2^31 points.
/// Cost:    O(n log n) time, 88 bytes per point.
/// Source:  Uddin, Yamazaki, Study of Distance Computation between Objects Represented by Discrete
///          Boundary Model, 2010, 4.2.1. The paper does not say where a node is split; the median
///          is our choice.
Result<SphereTree> sphere_tree(std::span<const Vec3> points);

/// Finds the closest pair of points by the search of the paper.
///
/// Frame:   the result is in that of A.
/// Result:  the least distance over all pairs, to the last bit, unless the goal asks for less; of
///          equally near pairs the first that the search meets, which depends only on the input.
///          Coinciding points end the search.
/// Cost:    a few thousand sphere tests for separated bodies; up to all pairs where faces are
///          parallel.
/// Source:  Uddin, Yamazaki, Study of Distance Computation between Objects Represented by Discrete
///          Boundary Model, 2010, 4.2.2. Limit, tolerance, sweep and first pair are additions.
ClosestPair closest_pair(const SphereTree& a, const SphereTree& b, const Transform& a_from_b,
                         const PairGoal& goal = {});

} // namespace core

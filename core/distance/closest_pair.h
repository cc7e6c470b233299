#pragma once

#include <cstdint>

#include "core/base/transform.h"
#include "core/distance/sphere_tree.h"

namespace core {

/// The nearest points of two bodies, and what it took to find them.
struct ClosestPair {
    double distance = infinity; // mm
    uint32_t point_a = 0;       // indices in the points the trees were built from
    uint32_t point_b = 0;
    Vec3 witness_a = Vec3(0.0); // both in the frame of A
    Vec3 witness_b = Vec3(0.0);
    uint64_t sphere_tests = 0; // pairs of spheres compared
    uint64_t point_tests = 0;  // pairs of points compared
};

/// Finds the closest pair of points by the paper's search.
///
/// Frame:  the result is in that of A.
/// Result: the least distance over all pairs, to the last bit; of equally near pairs the first that
///         the search meets, which depends on nothing but the input. Coinciding points end the
///         search.
/// Cost:   a few thousand sphere tests for bodies apart; up to all pairs where faces lie parallel.
/// Source: Uddin, Yamazaki, Study of Distance Computation between Objects Represented by Discrete
///         Boundary Model, 2010, 4.2.2.
ClosestPair closest_pair(const SphereTree& a, const SphereTree& b, const Transform& a_from_b);

} // namespace core

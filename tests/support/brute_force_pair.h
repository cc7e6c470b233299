#pragma once

#include <algorithm>
#include <vector>

#include "core/base/vec.h"
#include "core/distance/closest_pair.h"

namespace test_support {

/// The least distance of two sets of points while B moves by the sweep; tries every pair.
inline double brute_force_distance(const std::vector<core::Vec3>& a,
                                   const std::vector<core::Vec3>& b,
                                   const core::Transform& a_from_b,
                                   const core::PairGoal& goal = {}) {
    double least = core::infinity;
    for (const core::Vec3& q : b) {
        const core::Vec3 start = a_from_b * q;
        for (const core::Vec3& p : a)
            least = std::min(least, core::swept_distance(p - start, goal.sweep));
    }
    return least;
}

} // namespace test_support

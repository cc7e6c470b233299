#pragma once

#include <cstdint>
#include <optional>

#include "core/base/vec.h"

namespace core {

/// A point of each body, by its index among the points that the body was built from.
struct PointPair {
    uint64_t a = 0;
    uint64_t b = 0;

    bool operator==(const PointPair&) const = default;
};

/// What a search for the closest pair of points should find, and what is known beforehand.
struct PairGoal {
    double limit = infinity;        // mm: pairs at this distance or farther do not count
    bool any = false;               // any pair below the limit will do: "closer than m?"
    double tolerance = 0.0;         // mm: how much closer than the result another pair may be
    Vec3 sweep = Vec3(0.0);         // B moves by this; the least distance on the way counts
    std::optional<PointPair> first; // compared first: the last answer is a good guess
};

/// The nearest points of two bodies, and the cost of finding them.
struct ClosestPair {
    double distance = infinity; // mm; infinite if no pair is below the limit
    double lower = 0.0;         // no two points are closer than this
    PointPair points;
    Vec3 witness_a = Vec3(0.0); // both in the frame of A, B's at the time `at`
    Vec3 witness_b = Vec3(0.0);
    double at = 0.0;          // 0..1 of the sweep
    uint64_t node_tests = 0;  // pairs of nodes compared: spheres, or boxes
    uint64_t point_tests = 0; // pairs of points compared

    bool found() const { return distance < infinity; }
};

/// The time, 0..1, at which a point moving by `sweep` is nearest to another; `apart` is the vector
/// from the first to the second at time 0.
inline double nearest_time(const Vec3& apart, const Vec3& sweep) {
    const double length_squared = glm::dot(sweep, sweep);
    if (length_squared == 0.0) return 0.0;
    return std::clamp(glm::dot(apart, sweep) / length_squared, 0.0, 1.0);
}

/// The distance at nearest_time().
inline double swept_distance(const Vec3& apart, const Vec3& sweep) {
    return glm::length(apart - nearest_time(apart, sweep) * sweep);
}

/// The motion of B relative to A during one search: every point moves by the sweep at constant
/// speed. Frame: A's.
struct StraightMotion {
    Transform start;
    Vec3 sweep = Vec3(0.0);

    bool moves() const { return sweep != Vec3(0.0); }
    Transform last() const { return {start.rotation, start.translation + sweep}; }
};

} // namespace core

#pragma once

#include <optional>

#include "core/base/transform.h"
#include "core/distance/closest_pair.h"

namespace core {

/// Where a point of B is at first, and by how much it goes on.
struct MovingPoint {
    Vec3 at, sweep;
};

/// How B moves past A during one search: every point goes straight, at its own pace. Frame: A's.
struct StraightMotion {
    Transform start;
    Vec3 sweep = Vec3(0.0);
    std::optional<Transform> end; // where the points go instead of by `sweep`

    StraightMotion(const Transform& a_from_b, const PairGoal& goal)
        : start(a_from_b), sweep(goal.sweep), end(goal.end) {}

    bool moves() const { return end || sweep != Vec3(0.0); }

    MovingPoint of(const Vec3& p) const {
        const Vec3 at = start * p;
        return {at, end ? *end * p - at : sweep};
    }

    Transform last() const {
        return end ? *end : Transform{start.rotation, start.translation + sweep};
    }
};

} // namespace core

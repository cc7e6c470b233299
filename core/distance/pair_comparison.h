#pragma once

#include <algorithm>
#include <cmath>

#include "core/distance/search_side.h"

namespace core {

/// Compares points exactly, in double precision, by the same operations as brute force does, and
/// remembers the best pair.
class PairComparison {
public:
    PairComparison(const Transform& a_from_b, const PairGoal& goal)
        : motion_(a_from_b, goal), goal_(goal), moves_(motion_.moves()) {}

    /// Whether the goal is reached whatever else there is.
    bool done() const { return best_.distance == 0.0 || (goal_.any && best_.found()); }

    /// Only what is nearer than this is still of interest.
    double worth() const { return best_.found() ? best_.distance - goal_.tolerance : goal_.limit; }

    /// The answer, if nothing nearer than worth() is left out.
    ClosestPair finished() {
        best_.lower = done() ? 0.0 : std::max(worth(), 0.0);
        return best_;
    }

    /// Whether two points, of a body that stands still, cannot be the nearest.
    bool is_no_nearer(const Vec3& of_a, const Vec3& of_b) const {
        if (moves_) return false;
        const Vec3 apart = of_a - motion_.start * of_b;
        return !(glm::dot(apart, apart) < near_squared_);
    }

    void compare(const PointPlace& a, const PointPlace& b) {
        if (a.tree == nullptr || b.tree == nullptr) return; // cut away
        const Vec3& p = a.position();
        const MovingPoint q = motion_.of(b.position());
        const Vec3 apart = p - q.at;
        const double at = moves_ ? nearest_time(apart, q.sweep) : 0.0;
        const Vec3 then = moves_ ? apart - at * q.sweep : apart;
        const double squared = glm::dot(then, then);
        if (!(squared < near_squared_)) return;
        near_squared_ = squared;
        near_apart_ = -then;
        near_a_ = a, near_b_ = b;
        const double distance = std::sqrt(squared);
        if (!(distance < std::min(best_.distance, goal_.limit))) return;
        best_.distance = distance;
        best_.points = {a.index(), b.index()};
        best_.witness_a = p;
        best_.witness_b = q.at + at * q.sweep;
        best_.at = at;
    }

protected:
    const StraightMotion motion_;
    const PairGoal& goal_;
    const bool moves_;
    ClosestPair best_;
    // The nearest pair compared so far, also if beyond the limit.
    double near_squared_ = infinity;
    Vec3 near_apart_ = Vec3(0.0);
    PointPlace near_a_, near_b_;
};

} // namespace core

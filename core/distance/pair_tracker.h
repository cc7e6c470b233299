#pragma once

#include <memory>

#include "core/distance/distance_engine.h"

namespace core {

/// Asks about the same two bodies pose after pose, and makes use of what it has learnt: the last
/// closest pair is a good first guess, and a distance known at one pose bounds that at another by
/// how far B has moved between them.
///
/// The engine must outlive it. It is not for several threads; there may be many of them.
class PairTracker {
public:
    PairTracker(const DistanceEngine& engine, PointBody a, PointBody b);
    ~PairTracker();

    /// As DistanceEngine::closest_pair(), with the same distance to the last bit.
    Result<ClosestPair> closest_pair(const Transform& a_from_b, const PairGoal& goal = {});

    /// Whether any two points are nearer than `distance`. Most poses of a path that keeps away need
    /// no search.
    ///
    /// Errors: those of DistanceEngine::closest_pair; a distance that is no number.
    Result<bool> is_nearer(const Transform& a_from_b, double distance);

    /// What is known without a search: no two points are nearer at this pose.
    double lower_bound(const Transform& a_from_b) const;

    uint64_t searches() const { return searches_; } // made so far

private:
    Result<ClosestPair> search(const Transform& a_from_b, const PairGoal& goal);

    const DistanceEngine& engine_;
    PointBody a_, b_;
    Aabb box_of_a_, box_of_b_;
    std::unique_ptr<SearchMemory> memory_;
    std::optional<PointPair> nearest_;
    Transform known_pose_;
    double known_lower_ = 0.0; // at that pose
    uint64_t searches_ = 0;
};

} // namespace core

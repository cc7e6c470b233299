#pragma once

#include "core/base/vec.h"
#include "core/distance/closest_pair.h"
#include "core/distance/point_tree.h"
#include "core/distance/search_side.h"

namespace core {

/// A pair of boxes, each by the number of a visited node * 8 + lane.
struct BoxPair {
    float squared; // lower bound of their squared distance; in the beam, how far the middles are
    uint32_t a, b;
};

/// Two points, and how far apart they were when the front was filled.
struct FrontPair {
    double distance;
    PointPlace a, b;
};

/// All pairs of points that were nearer together than a limit when a search came by. While B moves
/// little, the closest pair is among them.
struct PairFront {
    std::vector<FrontPair> pairs; // nearest first
    Transform pose;               // of B when it was filled
    double limit = -1.0;          // no other pair was nearer; negative: nothing is known
};

/// What a search keeps for the next one.
struct SearchMemory {
    SearchSide a, b;
    std::vector<BoxPair> stack, beam;

    PairFront front;
    std::vector<BoxPair> near_leaves; // while it is filled

    // When a front is worth its while.
    std::optional<Transform> last_pose;
    double pairs_per_square = 0.0; // pairs of a front over the square of how far it reaches, 1/mm2
    int resting = 0;               // searches to go before that is found out again

    void forget_front() { front.limit = -1.0; }
};

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

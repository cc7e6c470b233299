#include <algorithm>
#include <limits>

#include "core/geom/triangle_bvh.h"
#include "core/geom/triangle_distance.h"

namespace core {
namespace {

double smallest(const Triangle& t, const Vec3& u) {
    return std::min({glm::dot(t.a, u), glm::dot(t.b, u), glm::dot(t.c, u)});
}

double greatest(const Triangle& t, const Vec3& u) {
    return std::max({glm::dot(t.a, u), glm::dot(t.b, u), glm::dot(t.c, u)});
}

/// The length of the longest vector to a point of the tree.
double reach(const TriangleBvh& tree) {
    const Aabb& box = tree.nodes[0].box;
    return glm::length(glm::max(glm::abs(box.min), glm::abs(box.max)));
}

/// The error of a bound of the search: see README.md, "Two meshes".
double rounding_of(const TriangleBvh& a, const TriangleBvh& b, const Transform& a_from_b,
                   const Vec3& sweep) {
    const double lengths =
        reach(a) + reach(b) + glm::length(a_from_b.translation) + glm::length(sweep);
    const double angles = 2.0 * box_lean + lean(a_from_b.rotation);
    return (64.0 * std::numeric_limits<double>::epsilon() + 4.0 * angles) * lengths;
}

Triangle moved(const Triangle& t, const Transform& by) { return {by * t.a, by * t.b, by * t.c}; }

/// Depth first through pairs of boxes, the nearer one first. Best-first search would open a third
/// fewer pairs, but its priority queue costs more than that.
class MeshPairSearch {
public:
    MeshPairSearch(const TriangleBvh& a, const TriangleBvh& b, const Transform& a_from_b,
                   const Vec3& sweep, const SeparationGoal& goal)
        : a_(a), b_(b), a_from_b_(a_from_b), sweep_(sweep), goal_(goal) {}

    Separation run() {
        if (a_.nodes.empty() || b_.nodes.empty()) return {};
        rounding_ = rounding_of(a_, b_, a_from_b_, sweep_);
        descend();
        put({bound(0, 0), 0, 0});
        while (!stack_.empty() && best_.upper > 0.0) {
            const Pair pair = stack_.back();
            stack_.pop_back();
            if (!skipped(pair.bound) && !skipped(gap_along_witness(pair))) open(pair);
        }
        return result();
    }

private:
    struct Pair {
        double bound;
        uint32_t a, b; // a node of each tree
    };

    /// Pairs with this bound or more are skipped.
    double enough() const {
        return std::min(goal_.limit + rounding_, best_.upper - goal_.tolerance);
    }

    Separation result() const {
        Separation found = best_;
        if (found.upper > 0.0) found.upper += rounding_;
        if (!(found.upper < goal_.limit)) found = {};
        const double lower = std::min(least_, best_.upper) - rounding_;
        found.lower = std::min(std::max(lower, 0.0), goal_.limit);
        return found;
    }

    bool skipped(double bound) {
        if (bound < enough()) return false;
        least_ = std::min(least_, bound);
        return true;
    }

    /// The gap along the direction of the nearest points so far: close to them it is tighter than
    /// the bound of the boxes.
    double gap_along_witness(const Pair& pair) const {
        const OrientedBox& a = a_.oriented[pair.a];
        const OrientedBox& b = b_.oriented[pair.b];
        return glm::dot(a_from_b_ * b.center - a.center, along_) + sweep_start_
               - a.half_along(along_) - b.half_along(along_in_b_);
    }

    /// Finds a first pair of triangles, for the direction between them.
    void descend() {
        Pair pair{0.0, 0, 0};
        for (;;) {
            const TriangleBvh::Node& node_a = a_.nodes[pair.a];
            const TriangleBvh::Node& node_b = b_.nodes[pair.b];
            if (node_a.is_leaf() && node_b.is_leaf()) return compare(node_a, node_b);
            const bool split_a = splits_a(pair);
            const uint32_t first = split_a ? node_a.first : node_b.first;
            Pair best{infinity, 0, 0};
            for (const uint32_t child : {first, first + 1}) {
                Pair next = pair;
                (split_a ? next.a : next.b) = child;
                const Vec3 apart =
                    a_from_b_ * b_.oriented[next.b].center - a_.oriented[next.a].center;
                next.bound = glm::dot(apart, apart);
                if (next.bound < best.bound) best = next;
            }
            pair = best;
        }
    }

    bool splits_a(const Pair& pair) const {
        if (a_.nodes[pair.a].is_leaf()) return false;
        if (b_.nodes[pair.b].is_leaf()) return true;
        const Vec3& half_a = a_.oriented[pair.a].half;
        const Vec3& half_b = b_.oriented[pair.b].half;
        return glm::dot(half_a, half_a) > glm::dot(half_b, half_b);
    }

    double bound(uint32_t a, uint32_t b) const {
        return distance_bound(a_.oriented[a], moved(b_.oriented[b], a_from_b_), sweep_);
    }

    void put(const Pair& pair) {
        if (!skipped(pair.bound)) stack_.push_back(pair);
    }

    void open(const Pair& pair) {
        const TriangleBvh::Node& node_a = a_.nodes[pair.a];
        const TriangleBvh::Node& node_b = b_.nodes[pair.b];
        if (node_a.is_leaf() && node_b.is_leaf()) return compare(node_a, node_b);
        Pair first = pair, second = pair;
        if (splits_a(pair)) {
            const OrientedBox box = moved(b_.oriented[pair.b], a_from_b_);
            first.a = node_a.first;
            second.a = node_a.first + 1;
            first.bound = distance_bound(a_.oriented[first.a], box, sweep_);
            second.bound = distance_bound(a_.oriented[second.a], box, sweep_);
        } else {
            first.b = node_b.first;
            second.b = node_b.first + 1;
            first.bound = bound(first.a, first.b);
            second.bound = bound(second.a, second.b);
        }
        if (second.bound < first.bound) std::swap(first, second);
        put(second);
        put(first);
    }

    void compare(const TriangleBvh::Node& node_a, const TriangleBvh::Node& node_b) {
        for (uint32_t j = node_b.first; j < node_b.first + node_b.count; ++j) {
            const Triangle b = moved(b_.triangles[j], a_from_b_);
            Aabb box = b.bounds();
            box.extend({box.min + sweep_, box.max + sweep_});
            for (uint32_t i = node_a.first; i < node_a.first + node_a.count; ++i) {
                const Triangle& a = a_.triangles[i];
                const double gap = smallest(b, along_) + sweep_start_ - greatest(a, along_);
                if (skipped(gap) || skipped(distance(a.bounds(), box))) continue;
                offer(separation_of(a, b));
                if (best_.upper == 0.0) return;
            }
        }
    }

    Separation separation_of(const Triangle& a, const Triangle& b) const {
        const SeparationGoal goal{goal_.tolerance, enough()};
        if (sweep_ == Vec3(0.0)) return separation(a, b, goal);
        const Vec3 positions[] = {Vec3(0.0), sweep_};
        Separation found = separation(swept(convex(b), positions), convex(a), goal);
        std::swap(found.point_a, found.point_b);
        return found;
    }

    void offer(const Separation& found) {
        least_ = std::min(least_, found.lower);
        if (found.upper >= best_.upper) return;
        best_ = found;
        const Vec3 way = found.point_b - found.point_a;
        if (!(glm::length(way) > 0.0)) return;
        along_ = glm::normalize(way);
        along_in_b_ = along_ * a_from_b_.rotation;
        sweep_start_ = std::min(0.0, glm::dot(sweep_, along_));
    }

    const TriangleBvh& a_;
    const TriangleBvh& b_;
    Transform a_from_b_;
    Vec3 sweep_;
    SeparationGoal goal_;
    double rounding_ = 0.0;
    std::vector<Pair> stack_;
    Separation best_;
    double least_ = infinity;     // least lower bound of all pairs that were decided
    Vec3 along_ = Vec3(0.0);      // direction from A to B; zero before a pair is found
    Vec3 along_in_b_ = Vec3(0.0); // the same direction in the frame of B
    double sweep_start_ = 0.0;    // distance by which B moves back along it
};

} // namespace

Separation separation(const TriangleBvh& a, const TriangleBvh& b, const Transform& a_from_b,
                      const Vec3& sweep_of_b, const SeparationGoal& goal) {
    return MeshPairSearch(a, b, a_from_b, sweep_of_b, goal).run();
}

} // namespace core

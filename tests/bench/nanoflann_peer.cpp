#include <nanoflann.hpp>

#include "tests/bench/peers.h"

namespace bench {
namespace {

/// The points in the interface of nanoflann.
struct Cloud {
    Points points;

    size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(size_t i, size_t axis) const { return points[i][static_cast<int>(axis)]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using Metric = nanoflann::L2_Simple_Adaptor<double, Cloud>;
using Tree = nanoflann::KDTreeSingleIndexAdaptor<Metric, Cloud, 3, uint32_t>;

struct IndexedCloud {
    explicit IndexedCloud(const Points& points) : cloud{points}, tree(3, cloud) {}
    Cloud cloud;
    Tree tree;
};

/// A result set with only the nearest point, starting with the best distance of earlier query
/// points.
// NOLINTBEGIN(readability-identifier-naming): nanoflann calls it by these names
struct Nearest {
    double squared;
    bool any; // any point will do

    double worstDist() const { return squared; }
    bool full() const { return true; }
    bool addPoint(double distance_squared, uint32_t) {
        squared = std::min(squared, distance_squared);
        return !any;
    }
};
// NOLINTEND(readability-identifier-naming)

double distance(const Tree& a, const Points& b, const core::Transform& a_from_b,
                const core::PairGoal& goal) {
    const double limit_squared = goal.limit * goal.limit;
    Nearest nearest{limit_squared, goal.any};
    for (const core::Vec3& point : b) {
        const core::Vec3 p = a_from_b * point;
        a.findNeighbors(nearest, &p.x, nanoflann::SearchParams());
        if (goal.any && nearest.squared < limit_squared) break;
    }
    return nearest.squared < limit_squared ? std::sqrt(nearest.squared) : core::infinity;
}

} // namespace

Contestant nanoflann_peer() {
    return {"nanoflann", 0.0,
            [](const Points& a, const Points& b) -> Prepared {
                return {[a = std::make_shared<IndexedCloud>(a), b](const auto& a_from_b,
                                                                   const auto& goal) {
                            return distance(a->tree, b, a_from_b, goal);
                        },
                        {}};
            },
            [](const Points& points) { return std::make_shared<IndexedCloud>(points); }};
}

} // namespace bench

#include "core/distance/distance_engine.h"

#include <cmath>
#include <deque>

#include <fmt/format.h>

#include "core/distance/point_search.h"
#include "core/distance/sphere_search.h"

namespace core {
namespace {

constexpr double farthest = 1e12; // mm, as for points
constexpr double gibibyte = 1024.0 * 1024.0 * 1024.0;
constexpr double rigid_to = 1e-9; // how far the columns may be from unit length and right angles

bool is_rigid(const Transform& t) {
    return distortion(t.rotation) <= rigid_to && glm::determinant(t.rotation) > 0.0;
}

bool is_near(const Vec3& v) { return glm::length(v) <= farthest; }

/// An engine that keeps a tree of each body.
template <typename Tree, Result<Tree> build(std::span<const Vec3>)>
class TreeEngine final : public DistanceEngine {
public:
    TreeEngine(std::string_view name, double bytes_per_point)
        : name_(name), bytes_(bytes_per_point) {}

    std::string_view name() const override { return name_; }

    Aabb box_of(PointBody body) const override {
        const auto i = static_cast<size_t>(body);
        return i < bodies_.size() ? bodies_[i].box : Aabb();
    }

private:
    struct Body {
        Tree tree;
        Aabb box;
    };

    double bytes_per_point() const override { return bytes_; }

    Result<PointBody> take_in(std::span<const Vec3> points) override {
        FEELER_TRY(Tree tree, build(points));
        Aabb box;
        for (const Vec3& p : points) box.extend(p);
        bodies_.push_back({std::move(tree), box});
        return PointBody(bodies_.size() - 1);
    }

    const Tree& tree(PointBody body) const { return bodies_[static_cast<size_t>(body)].tree; }

    size_t points_of(PointBody body) const override {
        const auto i = static_cast<size_t>(body);
        return i < bodies_.size() ? point_count(bodies_[i].tree) : 0;
    }

    ClosestPair search(PointBody a, PointBody b, const Transform& a_from_b, const PairGoal& goal,
                       SearchMemory* memory) const override {
        return search(tree(a), tree(b), a_from_b, goal, memory);
    }

    static ClosestPair search(const SphereTree& a, const SphereTree& b, const Transform& a_from_b,
                              const PairGoal& goal, SearchMemory*) {
        return core::closest_pair(a, b, a_from_b, goal);
    }
    static ClosestPair search(const PointTree& a, const PointTree& b, const Transform& a_from_b,
                              const PairGoal& goal, SearchMemory* memory) {
        if (!memory) return core::closest_pair(a, b, a_from_b, goal);
        return core::closest_pair({&a, {}}, {&b, {}}, a_from_b, goal, *memory);
    }

    Vec3 position(PointBody body, uint64_t point) const override {
        return point_at(tree(body), point);
    }

    static const Vec3& point_at(const SphereTree& tree, uint64_t point) {
        return tree.nodes[tree.leaf_of_point[point]].centre;
    }
    static const Vec3& point_at(const PointTree& tree, uint64_t point) {
        return tree.points[tree.place[point]];
    }
    static size_t point_count(const SphereTree& tree) { return tree.leaf_of_point.size(); }
    static size_t point_count(const PointTree& tree) { return tree.points.size(); }

    std::string_view name_;
    double bytes_;
    std::deque<Body> bodies_; // stay where they are
};

Result<PointTree> whole_point_tree(std::span<const Vec3> points) { return point_tree(points); }

} // namespace

Result<PointBody> DistanceEngine::add(std::span<const Vec3> points, double memory_limit) {
    const double needed = bytes_per_point() * static_cast<double>(points.size());
    if (needed > memory_limit)
        return fail(
            ErrorCode::invalid_value,
            fmt::format("a body of {} points would take {:.1f} GiB of memory, more than the "
                        "{:.1f} GiB that are allowed; a larger mesh size makes fewer points",
                        points.size(), needed / gibibyte, memory_limit / gibibyte));
    return take_in(points);
}

Result<void> DistanceEngine::check(PointBody a, PointBody b, const Transform& a_from_b,
                                   const PairGoal& goal) const {
    if (!is_rigid(a_from_b) || (goal.end && !is_rigid(*goal.end)))
        return fail(ErrorCode::invalid_value,
                    "the transform between the bodies is not a rotation: its columns must be at "
                    "right angles, of length 1, and not mirror");
    if (goal.end && goal.sweep != Vec3(0.0))
        return fail(ErrorCode::invalid_value,
                    "a body either moves on by a sweep or goes to an end, not both");
    if (!is_near(a_from_b.translation) || !is_near(goal.sweep)
        || (goal.end && !is_near(goal.end->translation)))
        return fail(ErrorCode::invalid_value,
                    "the bodies are moved by a length that is no number or beyond 1e12 mm");
    if (!(goal.limit >= 0.0) || !(goal.tolerance >= 0.0))
        return fail(ErrorCode::invalid_value,
                    "the limit and the tolerance of a search must be lengths of 0 or more");
    const size_t points_a = points_of(a), points_b = points_of(b);
    if (points_a == 0 || points_b == 0)
        return fail(ErrorCode::invalid_value, "the engine holds no body of that number");
    if (goal.first && (goal.first->a >= points_a || goal.first->b >= points_b))
        return fail(ErrorCode::invalid_value, "the pair given names a point that is not there");
    return {};
}

Result<ClosestPair> DistanceEngine::closest_pair(PointBody a, PointBody b,
                                                 const Transform& a_from_b, const PairGoal& goal,
                                                 SearchMemory* memory) const {
    if (auto checked = check(a, b, a_from_b, goal); !checked)
        return tl::unexpected(std::move(checked).error());
    return search(a, b, a_from_b, goal, memory);
}

Result<ClosestPair> DistanceEngine::pair_at(PointBody a, PointBody b, const PointPair& points,
                                            const Transform& a_from_b) const {
    if (auto checked = check(a, b, a_from_b, {.first = points}); !checked)
        return tl::unexpected(std::move(checked).error());
    ClosestPair pair{.points = points, .witness_a = position(a, points.a)};
    pair.witness_b = a_from_b * position(b, points.b);
    pair.distance = glm::distance(pair.witness_a, pair.witness_b);
    return pair;
}

std::unique_ptr<DistanceEngine> paper_engine() {
    return std::make_unique<TreeEngine<SphereTree, sphere_tree>>("paper", 90.0);
}

std::unique_ptr<DistanceEngine> fast_engine() {
    return std::make_unique<TreeEngine<PointTree, whole_point_tree>>("fast", 100.0);
}

} // namespace core

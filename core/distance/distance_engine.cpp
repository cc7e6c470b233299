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
constexpr double rigid_to = 1e-9; // tolerance for unit length and right angles of the columns

bool is_rigid(const Transform& t) {
    return distortion(t.rotation) <= rigid_to && glm::determinant(t.rotation) > 0.0;
}

bool is_near(const Vec3& v) { return glm::length(v) <= farthest; }

/// An engine with a tree for each body.
template <typename Tree, Result<Tree> build(std::span<const Vec3>)>
class TreeEngine final : public DistanceEngine {
public:
    TreeEngine(std::string_view name, double bytes_per_point)
        : name_(name), bytes_(bytes_per_point) {}

    std::string_view name() const override { return name_; }

private:
    double bytes_per_point() const override { return bytes_; }

    Result<PointBody> take_in(std::span<const Vec3> points) override {
        FEELER_TRY(Tree tree, build(points));
        bodies_.push_back(std::move(tree));
        return PointBody(bodies_.size() - 1);
    }

    const Tree& tree(PointBody body) const { return bodies_[static_cast<size_t>(body)]; }

    size_t points_of(PointBody body) const override {
        const auto i = static_cast<size_t>(body);
        return i < bodies_.size() ? point_count(bodies_[i]) : 0;
    }

    ClosestPair search(PointBody a, PointBody b, const Transform& a_from_b,
                       const PairGoal& goal) const override {
        return core::closest_pair(tree(a), tree(b), a_from_b, goal);
    }

    static size_t point_count(const SphereTree& tree) { return tree.leaf_of_point.size(); }
    static size_t point_count(const PointTree& tree) { return tree.points.size(); }

    std::string_view name_;
    double bytes_;
    std::deque<Tree> bodies_; // addresses are stable
};

} // namespace

Result<PointBody> DistanceEngine::add(std::span<const Vec3> points, double memory_limit) {
    const double needed = bytes_per_point() * static_cast<double>(points.size());
    if (needed > memory_limit)
        return fail(ErrorCode::invalid_value,
                    fmt::format("a body of {} points needs {:.1f} GiB of memory, more than the "
                                "limit of {:.1f} GiB; use a larger mesh size",
                                points.size(), needed / gibibyte, memory_limit / gibibyte));
    return take_in(points);
}

Result<void> DistanceEngine::check(PointBody a, PointBody b, const Transform& a_from_b,
                                   const PairGoal& goal) const {
    if (!is_rigid(a_from_b))
        return fail(ErrorCode::invalid_value,
                    "the transform between the bodies is not rigid: its columns must be "
                    "orthogonal, of length 1, and right-handed");
    if (!is_near(a_from_b.translation) || !is_near(goal.sweep))
        return fail(ErrorCode::invalid_value,
                    "a translation or sweep is not a number or beyond 1e12 mm");
    if (!(goal.limit >= 0.0) || !(goal.tolerance >= 0.0))
        return fail(ErrorCode::invalid_value,
                    "the limit and the tolerance of a search must be 0 or more");
    const size_t points_a = points_of(a), points_b = points_of(b);
    if (points_a == 0 || points_b == 0)
        return fail(ErrorCode::invalid_value, "the engine has no body with that number");
    if (goal.first && (goal.first->a >= points_a || goal.first->b >= points_b))
        return fail(ErrorCode::invalid_value, "the first pair names a point that does not exist");
    return {};
}

Result<ClosestPair> DistanceEngine::closest_pair(PointBody a, PointBody b,
                                                 const Transform& a_from_b,
                                                 const PairGoal& goal) const {
    if (auto checked = check(a, b, a_from_b, goal); !checked)
        return tl::unexpected(std::move(checked).error());
    return search(a, b, a_from_b, goal);
}

std::unique_ptr<DistanceEngine> paper_engine() {
    return std::make_unique<TreeEngine<SphereTree, sphere_tree>>("paper", 90.0);
}

std::unique_ptr<DistanceEngine> fast_engine() {
    return std::make_unique<TreeEngine<PointTree, point_tree>>("fast", 100.0);
}

} // namespace core

#include "core/distance/distance_engine.h"

#include <cmath>

#include "core/distance/sphere_search.h"

namespace core {
namespace {

constexpr double farthest = 1e12; // mm, as for points
constexpr double rigid_to = 1e-9; // how far the columns may be from unit length and right angles

bool is_rigid(const Transform& t) {
    const Mat3 product = glm::transpose(t.rotation) * t.rotation;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!(std::abs(product[i][j] - (i == j)) <= rigid_to)) return false;
    return glm::determinant(t.rotation) > 0.0;
}

bool is_near(const Vec3& v) { return glm::length(v) <= farthest; }

class PaperEngine final : public DistanceEngine {
public:
    std::string_view name() const override { return "paper"; }

    Result<PointBody> add(std::span<const Vec3> points) override {
        FEELER_TRY(SphereTree tree, sphere_tree(points));
        trees_.push_back(std::move(tree));
        return PointBody(trees_.size() - 1);
    }

private:
    const SphereTree& tree(PointBody body) const { return trees_[static_cast<size_t>(body)]; }

    ClosestPair search(PointBody a, PointBody b, const Transform& a_from_b,
                       const PairGoal& goal) const override {
        return core::closest_pair(tree(a), tree(b), a_from_b, goal);
    }

    std::vector<SphereTree> trees_;
};

} // namespace

Result<ClosestPair> DistanceEngine::closest_pair(PointBody a, PointBody b,
                                                 const Transform& a_from_b,
                                                 const PairGoal& goal) const {
    if (!is_rigid(a_from_b))
        return fail(ErrorCode::invalid_value,
                    "the transform between the bodies is not a rotation: its columns must be at "
                    "right angles, of length 1, and not mirror");
    if (!is_near(a_from_b.translation) || !is_near(goal.sweep))
        return fail(ErrorCode::invalid_value,
                    "the bodies are moved by a length that is no number or beyond 1e12 mm");
    if (!(goal.limit >= 0.0) || !(goal.tolerance >= 0.0))
        return fail(ErrorCode::invalid_value,
                    "the limit and the tolerance of a search must be lengths of 0 or more");
    return search(a, b, a_from_b, goal);
}

std::unique_ptr<DistanceEngine> paper_engine() { return std::make_unique<PaperEngine>(); }

} // namespace core

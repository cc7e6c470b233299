#include "core/distance/sphere_search.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/distance/closest_pair.h"
#include "core/distance/rounding.h"

namespace core {
namespace {

int longest_axis(const Vec3& size) {
    if (size.x >= size.y && size.x >= size.z) return 0;
    return size.y >= size.z ? 1 : 2;
}

class SphereTreeBuilder {
public:
    explicit SphereTreeBuilder(std::span<const Vec3> points)
        : points_(points), order_(points.size()), leaf_of_point_(points.size()) {
        std::iota(order_.begin(), order_.end(), uint32_t{0});
        nodes_.reserve(2 * points.size() - 1);
    }

    SphereTree build() && {
        add(order_);
        return {std::move(nodes_), std::move(leaf_of_point_)};
    }

private:
    /// Adds the node of these points, and all below it. Halving the points keeps the depth
    /// under 33.
    void add(std::span<uint32_t> group) {
        Aabb box;
        for (const uint32_t i : group) box.extend(points_[i]);
        const size_t node = nodes_.size();
        nodes_.push_back({.centre = box.center()});
        if (group.size() == 1) {
            nodes_[node] = {.centre = points_[group[0]], .point = group[0]};
            leaf_of_point_[group[0]] = static_cast<uint32_t>(node);
            return;
        }
        nodes_[node].radius = radius_about(nodes_[node].centre, group);
        const size_t half = group.size() / 2;
        split(group, half, longest_axis(box.size()));
        add(group.first(half));
        nodes_[node].right = static_cast<uint32_t>(nodes_.size());
        add(group.subspan(half));
    }

    double radius_about(const Vec3& centre, std::span<const uint32_t> group) const {
        double squared = 0.0;
        for (const uint32_t i : group) {
            const Vec3 d = points_[i] - centre;
            squared = std::max(squared, glm::dot(d, d));
        }
        return std::sqrt(squared);
    }

    void split(std::span<uint32_t> group, size_t half, int axis) const {
        const auto middle = group.begin() + static_cast<std::ptrdiff_t>(half);
        std::nth_element(group.begin(), middle, group.end(), [&](uint32_t a, uint32_t b) {
            const double at_a = points_[a][axis], at_b = points_[b][axis];
            return at_a != at_b ? at_a < at_b : a < b;
        });
        // nth_element fixes who is in which half, not their order; radii and boxes depend on the
        // former only.
    }

    std::span<const Vec3> points_;
    std::vector<uint32_t> order_;
    std::vector<uint32_t> leaf_of_point_;
    std::vector<SphereTree::Node> nodes_;
};

} // namespace

Result<SphereTree> sphere_tree(std::span<const Vec3> points) {
    FEELER_TRY([[maybe_unused]] const size_t count, checked_points(points));
    return SphereTreeBuilder(points).build();
}

namespace {

using Node = SphereTree::Node;

/// A pair of nodes still to be searched. The centre of B's was mapped when the pair was tested.
struct Pair {
    const Node* a;
    const Node* b;
    Vec3 b_centre; // at the start of the motion
    double gap;    // lower bound of the distance between their points
};

class SphereSearch {
public:
    SphereSearch(const SphereTree& a, const SphereTree& b, const Transform& a_from_b,
                 const PairGoal& goal)
        : motion_{a_from_b, goal.sweep},
          goal_(goal),
          moves_(motion_.moves()),
          rounding_(rounding_of(a.nodes[0], b.nodes[0], motion_)),
          a_root_(&a.nodes[0]),
          b_root_(&b.nodes[0]) {}

    ClosestPair run(const Node* first_a, const Node* first_b) {
        if (first_a) compare_points(tested(first_a, first_b, start_of(first_b)));
        push(tested(a_root_, b_root_, start_of(b_root_)));
        while (size_ > 0 && !done()) {
            const Pair pair = stack_[--size_];
            if (pair.gap >= worth()) continue;
            if (pair.a->is_leaf() && pair.b->is_leaf())
                compare_points(pair);
            else
                split(pair);
        }
        best_.lower = done() ? 0.0 : std::max(worth(), 0.0);
        return best_;
    }

private:
    /// Bound of the rounding of a gap computed from radii and mapped centres: some 10 operations on
    /// numbers up to the sum of all these lengths, and B's spheres becoming larger where its
    /// transform is not quite a rotation. Squares of lengths below 1e-150 mm underflow.
    static double rounding_of(const Node& a, const Node& b, const StraightMotion& motion) {
        const double reach = glm::length(a.centre) + a.radius + glm::length(b.centre) + b.radius
                             + glm::length(motion.start.translation)
                             + glm::length(motion.last().translation);
        const double stretch =
            std::max(distortion(motion.start.rotation), distortion(motion.last().rotation));
        return 1e-150 + 64.0 * std::numeric_limits<double>::epsilon() * reach
               + 2.0 * stretch * b.radius;
    }

    bool done() const { return best_.distance == 0.0 || (goal_.any && best_.found()); }

    /// Only pairs closer than this still matter.
    double worth() const { return best_.found() ? best_.distance - goal_.tolerance : goal_.limit; }

    double apart(const Vec3& a, const Vec3& b) const {
        return moves_ ? swept_distance(a - b, motion_.sweep) : glm::distance(a, b);
    }

    /// The centre of a sphere of B at the start of the motion.
    Vec3 start_of(const Node* b) const { return motion_.start * b->centre; }

    Pair tested(const Node* a, const Node* b, const Vec3& b_centre) {
        ++best_.node_tests;
        const double gap = apart(a->centre, b_centre);
        if (a->is_leaf() && b->is_leaf()) return {a, b, b_centre, gap};
        return {a, b, b_centre, gap - (a->radius + b->radius) - rounding_};
    }

    void push(const Pair& pair) {
        assert(size_ < stack_.size());
        if (pair.gap < worth()) stack_[size_++] = pair;
    }

    void compare_points(const Pair& pair) {
        ++best_.point_tests;
        if (!(pair.gap < std::min(best_.distance, goal_.limit))) return;
        best_.distance = pair.gap;
        best_.points = {pair.a->point, pair.b->point};
        best_.witness_a = pair.a->centre;
        best_.at = nearest_time(pair.a->centre - pair.b_centre, motion_.sweep);
        best_.witness_b = pair.b_centre + best_.at * motion_.sweep;
    }

    void split(const Pair& pair) {
        const bool split_a =
            !pair.a->is_leaf() && (pair.b->is_leaf() || pair.a->radius >= pair.b->radius);
        Pair near = split_a ? tested(pair.a + 1, pair.b, pair.b_centre)
                            : tested(pair.a, pair.b + 1, start_of(pair.b + 1));
        const Node* const a_right = a_root_ + pair.a->right;
        const Node* const b_right = b_root_ + pair.b->right;
        Pair far = split_a ? tested(a_right, pair.b, pair.b_centre)
                           : tested(pair.a, b_right, start_of(b_right));
        if (far.gap < near.gap) std::swap(near, far);
        push(far);
        push(near);
    }

    const StraightMotion motion_;
    const PairGoal& goal_;
    bool moves_;
    double rounding_;
    const Node* a_root_;
    const Node* b_root_;
    ClosestPair best_;
    // Each split replaces a pair by two, one level down: two trees of depth 33 leave at most 67.
    std::array<Pair, 72> stack_ = {};
    size_t size_ = 0;
};

} // namespace

ClosestPair closest_pair(const SphereTree& a, const SphereTree& b, const Transform& a_from_b,
                         const PairGoal& goal) {
    assert(!a.nodes.empty() && !b.nodes.empty());
    const auto leaf = [](const SphereTree& tree, uint64_t point) {
        return &tree.nodes[tree.leaf_of_point[point]];
    };
    return goal.first ? SphereSearch(a, b, a_from_b, goal)
                            .run(leaf(a, goal.first->a), leaf(b, goal.first->b))
                      : SphereSearch(a, b, a_from_b, goal).run(nullptr, nullptr);
}

} // namespace core

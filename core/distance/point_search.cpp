#include "core/distance/point_search.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/distance/lane_kernels.h"
#include "core/distance/search_side.h"

namespace core {

/// Compares points exactly, in double precision, by the same operations as brute force does, and
/// remembers the best pair.
class PairComparison {
public:
    PairComparison(const Transform& a_from_b, const PairGoal& goal)
        : motion_{a_from_b, goal.sweep}, goal_(goal), moves_(motion_.moves()) {}

    /// Whether the goal is reached already.
    bool done() const { return best_.distance == 0.0 || (goal_.any && best_.found()); }

    /// Only pairs closer than this still matter.
    double worth() const { return best_.found() ? best_.distance - goal_.tolerance : goal_.limit; }

    /// The result, provided that no pair closer than worth() was skipped.
    ClosestPair finished() {
        best_.lower = done() ? 0.0 : std::max(worth(), 0.0);
        return best_;
    }

    /// Whether two points of bodies at rest cannot be the nearest.
    bool is_no_nearer(const Vec3& of_a, const Vec3& of_b) const {
        if (moves_) return false;
        const Vec3 apart = of_a - motion_.start * of_b;
        return !(glm::dot(apart, apart) < near_squared_);
    }

    void compare(const PointLocation& a, const PointLocation& b) {
        if (a.tree == nullptr || b.tree == nullptr) return; // no first pair
        const Vec3& p = a.position();
        const Vec3 q = motion_.start * b.position();
        const Vec3 apart = p - q;
        const double at = moves_ ? nearest_time(apart, motion_.sweep) : 0.0;
        const Vec3 then = moves_ ? apart - at * motion_.sweep : apart;
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
        best_.witness_b = q + at * motion_.sweep;
        best_.at = at;
    }

protected:
    const StraightMotion motion_;
    const PairGoal& goal_;
    const bool moves_;
    ClosestPair best_;
    // The nearest pair compared so far, even if beyond the limit.
    double near_squared_ = infinity;
    Vec3 near_apart_ = Vec3(0.0);
    PointLocation near_a_, near_b_;
};

namespace {

constexpr uint32_t lane_width = PointTree::width;
constexpr size_t beam_width = 2; // pairs followed down to the leaves before the main search

/// The square of a length in single precision, rounded up.
float squared_above(double length) {
    const double squared = length * length * (1.0 + 2e-6) + 1e-37;
    return squared < 1e38 ? static_cast<float>(squared) : std::numeric_limits<float>::infinity();
}

Vec3 wide(const Float3& v) { return {v[0], v[1], v[2]}; }

/// A pair of boxes, each by the number of a visited node * 8 + lane.
struct BoxPair {
    float squared; // lower bound of their squared distance; in the beam, that of their centres
    uint32_t a, b;
};

/// Buffers of a search, one set per thread, so that searches need not allocate.
struct SearchBuffers {
    SearchSide a, b;
    std::vector<BoxPair> stack, beam;
};

bool nearer(const BoxPair& x, const BoxPair& y) {
    if (x.squared != y.squared) return x.squared < y.squared;
    return x.a != y.a ? x.a < y.a : x.b < y.b;
}

class PointSearch : private PairComparison {
public:
    PointSearch(const PointTree& a, const PointTree& b, const Transform& a_from_b,
                const PairGoal& goal, SearchBuffers& buffers)
        : PairComparison(a_from_b, goal),
          kernels_(lane_kernels()),
          body_a_(a),
          body_b_(b),
          a_(buffers.a),
          b_(buffers.b),
          stack_(buffers.stack),
          beam_(buffers.beam) {
        const double squared = glm::dot(goal.sweep, goal.sweep);
        per_length_ = squared > 1e-30 ? static_cast<float>(1.0 / squared) : 0.0F;
    }

    ClosestPair run() {
        if (goal_.first)
            compare(location_of(body_a_, goal_.first->a), location_of(body_b_, goal_.first->b));
        if (near_squared_ == infinity) {
            if (is_beyond_limit()) return finished();
            follow_the_middles();
        }
        start();
        search();
        return finished();
    }

private:
    /// Bound of the rounding of point distances in double precision at this pose and at another:
    /// some ten operations; squares of lengths below 1e-150 mm underflow.
    double rounding(const Transform& other) const {
        const auto reach = [](const PointTree& body) {
            const PointTree::Node& root = body.nodes[0];
            return glm::length(root.origin) + static_cast<double>(root.reach);
        };
        const double lengths = reach(body_a_) + reach(body_b_)
                               + glm::length(motion_.start.translation)
                               + glm::length(other.translation);
        return 1e-150 + 64.0 * std::numeric_limits<double>::epsilon() * lengths;
    }

    /// Whether the bounding balls show that nothing is within the limit.
    bool is_beyond_limit() const {
        if (goal_.limit == infinity) return false;
        const PointTree::Node& a = body_a_.nodes[0];
        const PointTree::Node& b = body_b_.nodes[0];
        const double reach = static_cast<double>(a.reach) + static_cast<double>(b.reach);
        const double apart = swept_distance(a.origin - motion_.start * b.origin, motion_.sweep);
        const double error = std::max(rounding(motion_.start), rounding(motion_.last()));
        return apart - reach > goal_.limit + 1e-6 * reach + error;
    }

    // --- the frame ---

    /// Restarts at the roots in the best frame known so far.
    void start() {
        frame_ = next_frame();
        sweep_ = single(frame_.along(motion_.sweep));
        limit_squared_ = squared_above(std::max(worth(), 0.0));
        a_.begin(body_a_, frame_, nullptr);
        b_.begin(body_b_, frame_, &motion_);
        start_from_roots();
    }

    void start_from_roots() {
        stack_.clear();
        const uint32_t lanes = b_.nodes[0].node->used;
        for (uint32_t left = lanes; left != 0; left &= left - 1)
            compare_boxes(a_, 0, b_, static_cast<uint32_t>(std::countr_zero(left)));
    }

    /// The direction across the gap of the nearest pair so far: the normals of its patches, which
    /// are more reliable than the pair itself.
    SearchFrame next_frame() const {
        const Vec3& middle_of_a = body_a_.nodes[0].origin;
        const Vec3 middle_of_b = motion_.start * body_b_.nodes[0].origin;
        if (!(near_squared_ > 0.0) || near_squared_ == infinity)
            return search_frame(middle_of_b - middle_of_a, Vec3(0.0), middle_of_a, motion_.sweep);
        const Vec3 between = near_apart_ / std::sqrt(near_squared_);
        return search_frame(across(between), wide(near_a_.leaf->along), near_a_.position(),
                            motion_.sweep);
    }

    Vec3 across(const Vec3& between) const {
        constexpr float curved = 0.3F, flat = 1e-3F; // thickness of a patch
        const auto normal = [&](const PointLocation& point, const Vec3& n) {
            const double facing = glm::dot(n, between);
            if (point.leaf->thickness > curved || std::abs(facing) < 0.5) return Vec3(0.0);
            return facing > 0.0 ? n : -n;
        };
        const Vec3 of_a = normal(near_a_, wide(near_a_.leaf->normal));
        const Vec3 of_b = normal(near_b_, motion_.start.rotation * wide(near_b_.leaf->normal));
        if (of_a != Vec3(0.0) && near_a_.leaf->thickness < flat) return of_a;
        if (of_b != Vec3(0.0) && near_b_.leaf->thickness < flat) return of_b;
        return of_a + of_b != Vec3(0.0) ? of_a + of_b : between;
    }

    // --- searching ---

    void search() {
        while (!stack_.empty() && !done()) {
            const BoxPair pair = stack_.back();
            stack_.pop_back();
            if (pair.squared < limit_squared_) open(pair);
        }
    }

    /// Descends to the leaves along the pairs with the nearest centres, so that the main search
    /// starts with a good pair and in a good frame.
    void follow_the_middles() {
        by_middles_ = true;
        start();
        while (!stack_.empty() && !done()) {
            const auto count = static_cast<std::ptrdiff_t>(std::min(beam_width, stack_.size()));
            std::partial_sort(stack_.begin(), stack_.begin() + count, stack_.end(), nearer);
            beam_.assign(stack_.begin(), stack_.begin() + count);
            stack_.clear();
            for (const BoxPair& pair : beam_) open(pair);
        }
        by_middles_ = false;
    }

    bool are_leaves(const BoxPair& pair) const {
        return a_.nodes[pair.a / lane_width].size[pair.a % lane_width] < 0.0F
               && b_.nodes[pair.b / lane_width].size[pair.b % lane_width] < 0.0F;
    }

    void open(const BoxPair& pair) {
        const uint32_t at_a = pair.a / lane_width, lane_a = pair.a % lane_width;
        const uint32_t at_b = pair.b / lane_width, lane_b = pair.b % lane_width;
        const float size_a = a_.nodes[at_a].size[lane_a], size_b = b_.nodes[at_b].size[lane_b];
        if (size_a < 0.0F && size_b < 0.0F)
            compare_leaves(pair);
        else if (size_a >= size_b)
            compare_boxes(a_, a_.child_node(at_a, lane_a), b_, pair.b);
        else
            compare_boxes(b_, b_.child_node(at_b, lane_b), a_, pair.a);
    }

    /// Compares the children of a node with one box of the other body.
    void compare_boxes(const SearchSide& side, uint32_t at, const SearchSide& other, uint32_t box) {
        const VisitedNode& node = side.nodes[at];
        const FrameBox facing = other.box(box / lane_width, box % lane_width);
        PointTree::Lanes squared;
        uint32_t lanes = node.node->used;
        best_.node_tests += node.count;
        if (by_middles_)
            kernels_.middles_apart(node.boxes, facing, squared);
        else
            lanes &= kernels_.near_boxes(node.boxes, facing, limit_squared_, squared);
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<uint32_t>(std::countr_zero(lanes));
            const uint32_t mine = at * lane_width + lane;
            stack_.push_back({squared[lane], &side == &a_ ? mine : box, &side == &a_ ? box : mine});
        }
    }

    void compare_leaves(const BoxPair& pair) {
        const VisitedLeaf& a = a_.child_leaf(pair.a / lane_width, pair.a % lane_width);
        const VisitedLeaf& b = b_.child_leaf(pair.b / lane_width, pair.b % lane_width);
        const float limit = limit_for(a, b);
        const uint32_t all = (1U << b.leaf->count) - 1U;
        const uint32_t rows =
            near_squared_ == infinity
                ? all
                : all & rows_near(b, a_.box(pair.a / lane_width, pair.a % lane_width), limit);
        if (rows == 0) return;
        const double before = near_squared_;
        if (near_squared_ < infinity)
            compare_rows(a, b, rows, limit);
        else // each row lowers the limit of the next
            for (uint32_t left = rows; left != 0; left &= left - 1)
                compare_rows(a, b, left & (0U - left), limit_for(a, b));
        if (near_squared_ < before) limit_squared_ = squared_above(std::max(worth(), 0.0));
    }

    /// The points of B that come near a box of A.
    uint32_t rows_near(const VisitedLeaf& b, FrameBox box, float limit) const {
        for (size_t k = 0; k < 3; ++k) { // B's points are at their start
            box.lower[k] -= std::max(sweep_[k], 0.0F);
            box.upper[k] -= std::min(sweep_[k], 0.0F);
        }
        return kernels_.near_box(b.points, box, limit);
    }

    /// Pairs of points farther apart than this in the frame do not matter.
    float limit_for(const VisitedLeaf& a, const VisitedLeaf& b) const {
        const double worth_of = by_middles_ ? std::sqrt(near_squared_) : std::max(worth(), 0.0);
        return squared_above(worth_of + 8.0 * static_cast<double>(a.margin + b.margin));
    }

    void compare_rows(const VisitedLeaf& a, const VisitedLeaf& b, uint32_t rows, float limit) {
        const Vec3* const of_a = &a.tree->points[a.leaf->first];
        const Vec3* const of_b = &b.tree->points[b.leaf->first];
        for_near(a, b, rows, limit, [&](uint32_t i, uint32_t j) {
            // Most pairs end here: between parallel faces all are equally near.
            if (!is_no_nearer(of_a[i], of_b[j])) compare(place_in(a, i), place_in(b, j));
        });
    }

    static PointLocation place_in(const VisitedLeaf& leaf, uint32_t i) {
        return {leaf.tree, leaf.leaf, leaf.leaf->first + i};
    }

    /// Calls act(point of A, point of B), counted in their leaves, for the pairs no farther apart
    /// than the limit.
    template <typename Act>
    void for_near(const VisitedLeaf& a, const VisitedLeaf& b, uint32_t rows, float limit,
                  const Act& act) {
        std::array<uint16_t, PointTree::leaf_size> columns;
        kernels_.near_points(a.points, b.points, rows, sweep_, per_length_, limit, columns);
        const uint32_t used = (1U << a.leaf->count) - 1U;
        for (; rows != 0; rows &= rows - 1) {
            const auto row = static_cast<uint32_t>(std::countr_zero(rows));
            best_.point_tests += a.leaf->count;
            for (uint32_t near = columns[row] & used; near != 0; near &= near - 1) {
                const auto column = static_cast<uint32_t>(std::countr_zero(near));
                act(column, row);
            }
        }
    }

    const LaneKernels& kernels_;
    const PointTree& body_a_;
    const PointTree& body_b_;
    bool by_middles_ = false;
    float per_length_ = 0.0F;
    Float3 sweep_{};
    SearchFrame frame_;
    SearchSide& a_;
    SearchSide& b_;
    std::vector<BoxPair>& stack_;
    std::vector<BoxPair>& beam_;
    float limit_squared_ = 0.0F;
};

} // namespace

ClosestPair closest_pair(const PointTree& a, const PointTree& b, const Transform& a_from_b,
                         const PairGoal& goal) {
    static thread_local SearchBuffers buffers;
    return PointSearch(a, b, a_from_b, goal, buffers).run();
}

} // namespace core

#include "core/distance/point_search.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/distance/lane_kernels.h"
#include "core/distance/search_frame.h"

namespace core {
namespace {

constexpr uint32_t width = PointTree::width;
constexpr uint32_t none = 0xFFFF'FFFFU;
constexpr size_t beam_width = 2; // pairs followed down to the leaves before the search proper

/// A node that the search came to, with its children's boxes in the search's frame.
struct Visited {
    BoxLanes boxes;
    PointTree::Lanes size;             // of the children: the larger one is opened; -1: a leaf
    std::array<uint32_t, width> below; // the children's numbers among the visited, or `none`
    const PointTree* tree;
    const PointTree::Node* node;
};

/// A leaf that it came to.
struct VisitedLeaf {
    PointLanes points;
    float margin; // what rounding may add to a coordinate or take from it
    const PointTree* tree;
    const PointTree::Leaf* leaf;
};

/// One body's part in a search.
struct Side {
    PointTreeView body;
    bool of_b = false;
    std::vector<Visited> nodes;
    std::vector<VisitedLeaf> leaves;
};

/// A pair of boxes still to be searched: visited node * width + lane.
struct Pair {
    float squared; // lower bound of their squared distance; in the beam, how far the middles are
    uint32_t a, b;
};

/// Memory that is kept from search to search.
struct Workspace {
    Side a, b;
    std::vector<Pair> stack, beam;
};

Workspace& workspace() {
    static thread_local Workspace space;
    return space;
}

/// Where a point is stored.
struct Place {
    const PointTree* tree = nullptr;
    const PointTree::Leaf* leaf = nullptr;
    uint32_t point = 0; // in the tree's order
};

/// The single precision that the frame's coordinates are off by, per length: direction, products
/// and sums take less than ten roundings.
constexpr float rounding = 16.0F * std::numeric_limits<float>::epsilon();

/// The square of a length in single precision, not less than it was.
float squared_above(double length) {
    const double squared = length * length * (1.0 + 2e-6) + 1e-37;
    return squared < 1e38 ? static_cast<float>(squared) : std::numeric_limits<float>::infinity();
}

FrameBox box_of(const Visited& node, uint32_t lane) {
    FrameBox box;
    for (size_t k = 0; k < 3; ++k) {
        box.lower[k] = node.boxes.lower[k][lane];
        box.upper[k] = node.boxes.upper[k][lane];
    }
    return box;
}

Float3 single(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

Vec3 wide(const Float3& v) { return {v[0], v[1], v[2]}; }

class Search {
public:
    Search(const PointTreeView& a, const PointTreeView& b, const Transform& a_from_b,
           const PairGoal& goal, Workspace& space)
        : kernels_(lane_kernels()),
          a_from_b_(a_from_b),
          goal_(goal),
          moves_(goal.sweep != Vec3(0.0)),
          a_(space.a),
          b_(space.b),
          stack_(space.stack),
          beam_(space.beam) {
        a_.body = a, a_.of_b = false;
        b_.body = b, b_.of_b = true;
        const double squared = glm::dot(goal.sweep, goal.sweep);
        per_length_ = squared > 0.0 ? static_cast<float>(1.0 / squared) : 0.0F;
    }

    ClosestPair run() {
        if (goal_.first)
            compare_first(place_of(a_.body, goal_.first->a), place_of(b_.body, goal_.first->b));
        if (near_squared_ == infinity) follow_the_middles();
        start();
        search();
        best_.lower = done() ? 0.0 : std::max(worth(), 0.0);
        return best_;
    }

private:
    bool done() const { return best_.distance == 0.0 || (goal_.any && best_.found()); }

    /// Only what is nearer than this is still of interest.
    double worth() const { return best_.found() ? best_.distance - goal_.tolerance : goal_.limit; }

    // --- the frame ---

    /// Begins afresh at the roots, in the best frame known by now.
    void start() {
        frame_ = next_frame();
        sweep_ = single(frame_.sweep);
        limit_squared_ = squared_above(std::max(worth(), 0.0));
        for (Side* side : {&a_, &b_}) {
            side->nodes.clear();
            side->leaves.clear();
            visit(*side, side->body.top, 0);
        }
        stack_.clear();
        const uint32_t lanes = b_.nodes[0].node->used;
        for (uint32_t left = lanes; left != 0; left &= left - 1)
            compare_boxes(a_, 0, b_, static_cast<uint32_t>(std::countr_zero(left)));
    }

    /// Across the gap of the nearest pair so far: along the normals of the patches it lies on,
    /// which tell better than the pair itself where the surfaces face each other.
    SearchFrame next_frame() const {
        const Vec3 between_roots =
            a_from_b_ * b_.body.top->nodes[0].origin - a_.body.top->nodes[0].origin;
        if (!(near_squared_ > 0.0) || near_squared_ == infinity)
            return search_frame(between_roots, Vec3(0.0), a_.body.top->nodes[0].origin, a_from_b_,
                                goal_.sweep);
        const Vec3 between = near_apart_ / std::sqrt(near_squared_);
        return search_frame(across(between), wide(near_a_.leaf->along),
                            near_a_.tree->points[near_a_.point], a_from_b_, goal_.sweep);
    }

    Vec3 across(const Vec3& between) const {
        constexpr float curved = 0.3F, flat = 1e-3F; // thickness of a patch
        const auto normal = [&](const Place& place, const Vec3& n) {
            const double facing = glm::dot(n, between);
            if (place.leaf->thickness > curved || std::abs(facing) < 0.5) return Vec3(0.0);
            return facing > 0.0 ? n : -n;
        };
        const Vec3 of_a = normal(near_a_, wide(near_a_.leaf->normal));
        const Vec3 of_b = normal(near_b_, a_from_b_.rotation * wide(near_b_.leaf->normal));
        if (of_a != Vec3(0.0) && near_a_.leaf->thickness < flat) return of_a;
        if (of_b != Vec3(0.0) && near_b_.leaf->thickness < flat) return of_b;
        return of_a + of_b != Vec3(0.0) ? of_a + of_b : between;
    }

    /// How a node or leaf of a body is seen in the frame, and what rounding may add, per axis.
    struct Sight {
        FrameView view;
        Float3 base{}, margin{};
    };

    Sight sight(const Side& side, const Vec3& origin, float reach) const {
        Sight sight;
        const Vec3 from = (side.of_b ? a_from_b_ * origin : origin) - frame_.origin;
        for (int k = 0; k < 3; ++k) {
            const auto i = static_cast<size_t>(k);
            const double base = glm::dot(frame_.in_a[i], from);
            const double sweep = side.of_b ? frame_.sweep[k] : 0.0;
            sight.base[i] = static_cast<float>(base);
            sight.margin[i] =
                rounding * (static_cast<float>(std::abs(base) + std::abs(sweep)) + reach);
            sight.view.lower[i] = static_cast<float>(base + std::min(sweep, 0.0)) - sight.margin[i];
            sight.view.upper[i] = static_cast<float>(base + std::max(sweep, 0.0)) + sight.margin[i];
            sight.view.direction[i] = single((side.of_b ? frame_.in_b : frame_.in_a)[i]);
        }
        return sight;
    }

    // --- what is visited ---

    uint32_t visit(Side& side, const PointTree* tree, uint32_t number) {
        const auto id = static_cast<uint32_t>(side.nodes.size());
        Visited& visited = side.nodes.emplace_back();
        visited.tree = tree;
        visited.node = &tree->nodes[number];
        visited.below.fill(none);
        for (uint32_t lane = 0; lane < width; ++lane) {
            const bool leaf = (visited.node->child[lane] & PointTree::leaf_flag) != 0;
            visited.size[lane] = leaf ? -1.0F : visited.node->radius[lane];
        }
        kernels_.project_boxes(*visited.node,
                               sight(side, visited.node->origin, visited.node->reach).view,
                               visited.boxes);
        return id;
    }

    uint32_t child_node(Side& side, uint32_t at, uint32_t lane) {
        const uint32_t known = side.nodes[at].below[lane];
        if (known != none) return known;
        const uint32_t child = side.nodes[at].node->child[lane];
        const bool tile = (child & PointTree::tile_flag) != 0;
        const uint32_t id = tile ? visit(side, side.body.tile(child & ~PointTree::tile_flag), 0)
                                 : visit(side, side.nodes[at].tree, child);
        side.nodes[at].below[lane] = id;
        return id;
    }

    const VisitedLeaf& child_leaf(Side& side, uint32_t at, uint32_t lane) {
        Visited& parent = side.nodes[at];
        if (parent.below[lane] != none) return side.leaves[parent.below[lane]];
        parent.below[lane] = static_cast<uint32_t>(side.leaves.size());
        VisitedLeaf& visited = side.leaves.emplace_back();
        visited.tree = parent.tree;
        visited.leaf = &parent.tree->leaves[parent.node->child[lane] & ~PointTree::leaf_flag];
        Sight seen = sight(side, visited.leaf->origin, visited.leaf->reach);
        seen.view.lower = seen.base;
        visited.margin = *std::max_element(seen.margin.begin(), seen.margin.end());
        kernels_.project_points(*visited.leaf, seen.view, visited.points);
        return visited;
    }

    // --- searching ---

    void search() {
        while (!stack_.empty() && !done()) {
            const Pair pair = stack_.back();
            stack_.pop_back();
            if (pair.squared < limit_squared_) open(pair);
        }
    }

    /// Follows the pairs whose middles are nearest down to the leaves: the search proper then
    /// begins with a good pair, and in a good frame.
    void follow_the_middles() {
        by_middles_ = true;
        start();
        const auto nearer = [](const Pair& x, const Pair& y) {
            if (x.squared != y.squared) return x.squared < y.squared;
            return x.a != y.a ? x.a < y.a : x.b < y.b;
        };
        while (!stack_.empty() && !done()) {
            const auto count = static_cast<std::ptrdiff_t>(std::min(beam_width, stack_.size()));
            std::partial_sort(stack_.begin(), stack_.begin() + count, stack_.end(), nearer);
            beam_.assign(stack_.begin(), stack_.begin() + count);
            stack_.clear();
            for (const Pair& pair : beam_) open(pair);
        }
        by_middles_ = false;
    }

    void open(const Pair& pair) {
        const uint32_t at_a = pair.a / width, lane_a = pair.a % width;
        const uint32_t at_b = pair.b / width, lane_b = pair.b % width;
        const float size_a = a_.nodes[at_a].size[lane_a], size_b = b_.nodes[at_b].size[lane_b];
        if (size_a < 0.0F && size_b < 0.0F)
            compare_leaves(pair);
        else if (size_a >= size_b)
            compare_boxes(a_, child_node(a_, at_a, lane_a), b_, pair.b);
        else
            compare_boxes(b_, child_node(b_, at_b, lane_b), a_, pair.a);
    }

    /// Compares the children of a node with one box of the other body.
    void compare_boxes(const Side& side, uint32_t at, const Side& other, uint32_t box) {
        const Visited& node = side.nodes[at];
        const FrameBox facing = box_of(other.nodes[box / width], box % width);
        PointTree::Lanes squared;
        uint32_t lanes = node.node->used;
        best_.node_tests += static_cast<uint64_t>(std::popcount(lanes));
        if (by_middles_)
            kernels_.middles_apart(node.boxes, facing, squared);
        else
            lanes &= kernels_.near_boxes(node.boxes, facing, limit_squared_, squared);
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<uint32_t>(std::countr_zero(lanes));
            const uint32_t mine = at * width + lane;
            stack_.push_back({squared[lane], side.of_b ? box : mine, side.of_b ? mine : box});
        }
    }

    void compare_leaves(const Pair& pair) {
        const VisitedLeaf& a = child_leaf(a_, pair.a / width, pair.a % width);
        const VisitedLeaf& b = child_leaf(b_, pair.b / width, pair.b % width);
        const float limit = limit_for(a, b);
        FrameBox box = box_of(a_.nodes[pair.a / width], pair.a % width);
        for (size_t k = 0; k < 3; ++k) { // B's points are where they start
            box.lower[k] -= std::max(sweep_[k], 0.0F);
            box.upper[k] -= std::min(sweep_[k], 0.0F);
        }
        const uint32_t all = (1U << b.leaf->count) - 1U;
        const uint32_t rows =
            near_squared_ == infinity ? all : all & kernels_.near_box(b.points, box, limit);
        if (rows == 0) return;
        best_.point_tests += static_cast<uint64_t>(std::popcount(rows)) * a.leaf->count;
        const double before = near_squared_;
        if (near_squared_ < infinity)
            compare_rows(a, b, rows, limit);
        else // each row lowers the limit of the next
            for (uint32_t left = rows; left != 0; left &= left - 1)
                compare_rows(a, b, left & (0U - left), limit_for(a, b));
        if (near_squared_ < before) limit_squared_ = squared_above(std::max(worth(), 0.0));
    }

    /// No pair of points that is farther apart than this in the frame can be of interest.
    float limit_for(const VisitedLeaf& a, const VisitedLeaf& b) const {
        const double worth_of = by_middles_ ? std::sqrt(near_squared_) : std::max(worth(), 0.0);
        return squared_above(worth_of + 4.0 * static_cast<double>(a.margin + b.margin));
    }

    void compare_rows(const VisitedLeaf& a, const VisitedLeaf& b, uint32_t rows, float limit) {
        std::array<uint16_t, PointTree::leaf_size> columns;
        kernels_.near_points(a.points, b.points, rows, sweep_, per_length_, limit, columns);
        const uint32_t used = (1U << a.leaf->count) - 1U;
        for (; rows != 0; rows &= rows - 1) {
            const auto row = static_cast<uint32_t>(std::countr_zero(rows));
            for (uint32_t near = columns[row] & used; near != 0; near &= near - 1) {
                const auto column = static_cast<uint32_t>(std::countr_zero(near));
                compare({a.tree, a.leaf, a.leaf->first + column},
                        {b.tree, b.leaf, b.leaf->first + row});
            }
        }
    }

    /// The exact comparison, in double precision; the same operations as brute force does.
    void compare(const Place& a, const Place& b) {
        const Vec3 p = a.tree->points[a.point];
        const Vec3 q = a_from_b_ * b.tree->points[b.point];
        const Vec3 apart = p - q;
        const double at = moves_ ? nearest_time(apart, goal_.sweep) : 0.0;
        const Vec3 then = moves_ ? apart - at * goal_.sweep : apart;
        const double squared = glm::dot(then, then);
        if (!(squared < near_squared_)) return;
        near_squared_ = squared;
        near_apart_ = -then;
        near_a_ = a, near_b_ = b;
        const double distance = std::sqrt(squared);
        if (!(distance < std::min(best_.distance, goal_.limit))) return;
        best_.distance = distance;
        best_.points = {a.tree->index[a.point], b.tree->index[b.point]};
        best_.witness_a = p;
        best_.witness_b = q + at * goal_.sweep;
        best_.at = at;
    }

    void compare_first(const Place& a, const Place& b) {
        if (a.leaf != nullptr && b.leaf != nullptr) compare(a, b);
    }

    /// Where the point with this index is; nowhere if it has been cut away.
    static Place place_of(const PointTreeView& body, uint64_t index) {
        const PointTree* tree = body.tree_of(index);
        const size_t given = index & 0xFFFF'FFFFU;
        if (tree == nullptr || given >= tree->place.size()) return {};
        const uint32_t point = tree->place[given];
        const auto after = std::upper_bound(
            tree->leaves.begin(), tree->leaves.end(), point,
            [](uint32_t p, const PointTree::Leaf& leaf) { return p < leaf.first; });
        return {tree, &*(after - 1), point};
    }

    const LaneKernels& kernels_;
    const Transform& a_from_b_;
    const PairGoal& goal_;
    bool moves_;
    bool by_middles_ = false;
    float per_length_ = 0.0F;
    Float3 sweep_{};
    Side& a_;
    Side& b_;
    std::vector<Pair>& stack_;
    std::vector<Pair>& beam_;
    SearchFrame frame_;
    ClosestPair best_;
    float limit_squared_ = 0.0F;
    // The nearest pair compared so far, also if beyond the limit.
    double near_squared_ = infinity;
    Vec3 near_apart_ = Vec3(0.0);
    Place near_a_, near_b_;
};

} // namespace

ClosestPair closest_pair(const PointTreeView& a, const PointTreeView& b, const Transform& a_from_b,
                         const PairGoal& goal) {
    return Search(a, b, a_from_b, goal, workspace()).run();
}

} // namespace core

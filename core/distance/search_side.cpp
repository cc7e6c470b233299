#include "core/distance/search_side.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace core {
namespace {

/// The component of `v` orthogonal to the unit vector `u`, normalised; zero if it is tiny.
Vec3 perpendicular(const Vec3& v, const Vec3& u) {
    const double length = glm::length(v);
    if (!(length > 0.0)) return Vec3(0.0);
    const Vec3 part = v / length - glm::dot(v / length, u) * u;
    return glm::length(part) > 1e-3 ? glm::normalize(part) : Vec3(0.0);
}

/// Any direction orthogonal to `u`.
Vec3 any_perpendicular(const Vec3& u) {
    const Vec3 a = glm::abs(u);
    const int least = a.x <= a.y && a.x <= a.z ? 0 : a.y <= a.z ? 1 : 2;
    Vec3 axis(0.0);
    axis[least] = 1.0;
    return perpendicular(axis, u);
}

} // namespace

SearchFrame search_frame(const Vec3& across, const Vec3& along, const Vec3& origin,
                         const Vec3& sweep) {
    const double length = glm::length(across);
    const Vec3 u = length > 0.0 ? across / length : Vec3(1.0, 0.0, 0.0);
    Vec3 v = perpendicular(sweep, u);
    if (v == Vec3(0.0)) v = perpendicular(along, u);
    if (v == Vec3(0.0)) v = any_perpendicular(u);
    return {{u, v, glm::cross(u, v)}, origin};
}

namespace {

constexpr uint32_t lane_count = PointTree::width;

/// Relative rounding of coordinates in the frame in single precision: direction, products and sums
/// take less than ten roundings.
constexpr float rounding = 16.0F * std::numeric_limits<float>::epsilon();

/// Bound of rounding in double precision: coordinates in the frame and distances of points take
/// about ten operations on numbers as large as these lengths. A path of less than 1e-15 mm is
/// ignored.
float coarse(const PointTree& tree, const Vec3& origin, const StraightMotion* motion) {
    const PointTree::Node& root = tree.nodes[0];
    double reach = glm::length(root.origin) + static_cast<double>(root.reach) + glm::length(origin);
    if (motion)
        reach += glm::length(motion->start.translation) + glm::length(motion->last().translation);
    return static_cast<float>(1e-14 + 32.0 * std::numeric_limits<double>::epsilon() * reach);
}

} // namespace

PointLocation location_of(const PointTree& tree, uint64_t index) {
    if (index >= tree.position.size()) return {};
    const uint32_t point = tree.position[index];
    const auto after =
        std::upper_bound(tree.leaves.begin(), tree.leaves.end(), point,
                         [](uint32_t p, const PointTree::Leaf& leaf) { return p < leaf.first; });
    return {&tree, &*(after - 1), point};
}

void SearchSide::begin(const PointTree& tree, const SearchFrame& frame,
                       const StraightMotion* motion) {
    kernels_ = &lane_kernels();
    tree_ = &tree;
    node_count_ = leaf_count_ = 0;
    start_ = pose_in(frame, motion ? motion->start : Transform{});
    sweep_ = motion ? frame.along(motion->sweep) : Vec3(0.0);
    coarse_ = coarse(tree, frame.origin, motion);
    visit(0);
}

SearchSide::Pose SearchSide::pose_in(const SearchFrame& frame, const Transform& a_from_body) {
    Pose pose;
    const Mat3 body_from_a = glm::transpose(a_from_body.rotation);
    for (size_t k = 0; k < 3; ++k) pose.directions[k] = body_from_a * frame.directions[k];
    const Mat3 frame_from_a =
        glm::transpose(Mat3(frame.directions[0], frame.directions[1], frame.directions[2]));
    pose.frame_from_body = {frame_from_a * a_from_body.rotation,
                            frame_from_a * (a_from_body.translation - frame.origin)};
    return pose;
}

SearchSide::NodeView SearchSide::sight(const Vec3& origin, float reach) const {
    NodeView sight;
    const Vec3 from = start_.frame_from_body * origin;
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<size_t>(k);
        sight.base[i] = static_cast<float>(from[k]);
        sight.margin[i] =
            coarse_
            + rounding * (static_cast<float>(std::abs(from[k]) + std::abs(sweep_[k])) + reach);
        sight.view.lower[i] =
            static_cast<float>(from[k] + std::min(sweep_[k], 0.0)) - sight.margin[i];
        sight.view.upper[i] =
            static_cast<float>(from[k] + std::max(sweep_[k], 0.0)) + sight.margin[i];
        sight.view.direction[i] = single(start_.directions[i]);
    }
    return sight;
}

uint32_t SearchSide::visit(uint32_t number) {
    const uint32_t id = node_count_++;
    if (id == nodes.size()) nodes.emplace_back();
    VisitedNode& visited = nodes[id];
    const PointTree::Node& node = tree_->nodes[number];
    visited.node = &node;
    visited.count = static_cast<uint32_t>(std::popcount(node.used));
    visited.below.fill(none);
    for (uint32_t lane = 0; lane < lane_count; ++lane) {
        const bool leaf = (node.child[lane] & PointTree::leaf_flag) != 0;
        visited.size[lane] = leaf ? -1.0F : node.radius[lane];
    }
    kernels_->project_boxes(node, sight(node.origin, node.reach).view, visited.boxes);
    return id;
}

uint32_t SearchSide::child_node(uint32_t at, uint32_t lane) {
    const uint32_t known = nodes[at].below[lane];
    if (known != none) return known;
    const uint32_t id = visit(nodes[at].node->child[lane]);
    nodes[at].below[lane] = id;
    return id;
}

const VisitedLeaf& SearchSide::child_leaf(uint32_t at, uint32_t lane) {
    VisitedNode& parent = nodes[at];
    uint32_t& id = parent.below[lane];
    if (id != none) return leaves[id];
    id = leaf_count_++;
    if (id == leaves.size()) leaves.emplace_back();
    VisitedLeaf& leaf = leaves[id];
    leaf.tree = tree_;
    leaf.leaf = &tree_->leaves[parent.node->child[lane] & ~PointTree::leaf_flag];
    project(leaf);
    return leaf;
}

void SearchSide::project(VisitedLeaf& leaf) const {
    NodeView seen = sight(leaf.leaf->origin, leaf.leaf->reach);
    seen.view.lower = seen.base;
    leaf.margin = *std::max_element(seen.margin.begin(), seen.margin.end());
    kernels_->project_points(*leaf.leaf, seen.view, leaf.points);
}

FrameBox SearchSide::box(uint32_t at, uint32_t lane) const {
    const VisitedNode& node = nodes[at];
    FrameBox box;
    for (size_t k = 0; k < 3; ++k) {
        box.lower[k] = node.boxes.lower[k][lane];
        box.upper[k] = node.boxes.upper[k][lane];
    }
    return box;
}

} // namespace core

#include "render/cluster_tree.h"

#include <algorithm>
#include <span>

namespace render {
namespace {

/// A cell of the tree on its way up.
struct ClusterNode {
    ClusterCell cell;
    std::vector<uint32_t> leaves;
    bool is_one = true; // one place stands for all of it; else what is in it has been settled
};

uint64_t order_of(const CellKey& key) {
    return uint64_t(key[0]) << 42 | uint64_t(key[1]) << 21 | uint64_t(key[2]);
}

CellKey parent_of(const CellKey& key) { return {key[0] / 2, key[1] / 2, key[2] / 2}; }

void settle(const ClusterNode& node, double width, Clusters& clusters) {
    if (!node.is_one) return;
    for (const uint32_t leaf : node.leaves)
        clusters.of_leaf[leaf] = static_cast<uint32_t>(clusters.places.size());
    clusters.places.push_back(node.cell.place(width));
}

/// The cells of one parent as one, if that may be; else they are settled.
ClusterNode join(std::span<ClusterNode> children, double width, double tolerance,
                 Clusters& clusters) {
    ClusterNode parent;
    parent.cell.key = parent_of(children.front().cell.key);
    for (const ClusterNode& child : children) {
        parent.is_one = parent.is_one && child.is_one;
        parent.cell.add(child.cell);
    }
    if (parent.is_one && children.size() > 1) {
        const core::Vec3 place = parent.cell.place(2.0 * width);
        parent.is_one = parent.cell.planes.at(place) <= tolerance;
    }
    for (ClusterNode& child : children) {
        if (parent.is_one)
            parent.leaves.insert(parent.leaves.end(), child.leaves.begin(), child.leaves.end());
        else
            settle(child, width, clusters);
    }
    return parent;
}

} // namespace

void ClusterCell::add(const ClusterCell& other) {
    planes.add(other.planes);
    sum += other.sum;
    corners += other.corners;
}

core::Vec3 ClusterCell::place(double width) const {
    const core::Vec3 mean = sum / static_cast<double>(corners);
    const core::Vec3 met = planes.least(mean), off = glm::abs(met - mean);
    return std::max({off.x, off.y, off.z}) <= width ? met : mean;
}

Clusters joined(const std::vector<ClusterCell>& leaves, double width, double tolerance) {
    Clusters clusters;
    clusters.of_leaf.resize(leaves.size());
    std::vector<ClusterNode> nodes;
    for (uint32_t i = 0; i < leaves.size(); ++i) nodes.push_back({leaves[i], {i}});
    while (nodes.size() > 1) {
        std::sort(nodes.begin(), nodes.end(), [](const ClusterNode& a, const ClusterNode& b) {
            return order_of(parent_of(a.cell.key)) < order_of(parent_of(b.cell.key));
        });
        std::vector<ClusterNode> parents;
        for (size_t i = 0; i < nodes.size();) {
            const uint64_t key = order_of(parent_of(nodes[i].cell.key));
            size_t end = i + 1;
            while (end < nodes.size() && order_of(parent_of(nodes[end].cell.key)) == key) ++end;
            parents.push_back(
                join(std::span(nodes).subspan(i, end - i), width, tolerance, clusters));
            i = end;
        }
        nodes = std::move(parents);
        width *= 2.0;
    }
    for (const ClusterNode& node : nodes) settle(node, width, clusters);
    return clusters;
}

} // namespace render

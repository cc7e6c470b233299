#include "core/distance/box_tree.h"

#include <algorithm>
#include <numeric>

namespace core {
namespace {

constexpr uint32_t box_leaf_size = 2;

struct BoxTreeBuilder {
    const std::vector<Aabb>& boxes;
    std::vector<uint32_t> order;
    std::vector<BoxTree::Node> nodes;

    void build(uint32_t node, uint32_t first, uint32_t last) {
        Aabb box;
        for (uint32_t i = first; i < last; ++i) box.extend(boxes[order[i]]);
        nodes[node].box = box;
        if (last - first <= box_leaf_size) {
            nodes[node].first = first;
            nodes[node].count = last - first;
            return;
        }
        const uint32_t middle = split(first, last);
        const auto child = static_cast<uint32_t>(nodes.size());
        nodes[node].first = child;
        nodes.resize(nodes.size() + 2);
        build(child, first, middle);
        build(child + 1, middle, last);
    }

    /// Halves the range along the axis on which the middles of the boxes spread most.
    uint32_t split(uint32_t first, uint32_t last) {
        Aabb middles;
        for (uint32_t i = first; i < last; ++i) middles.extend(boxes[order[i]].center());
        const Vec3 size = middles.size();
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const auto key = [&](uint32_t i) { return boxes[i].min[axis] + boxes[i].max[axis]; };
        const uint32_t middle = first + (last - first) / 2;
        std::nth_element(
            order.begin() + first, order.begin() + middle, order.begin() + last,
            [&](uint32_t i, uint32_t j) { return key(i) != key(j) ? key(i) < key(j) : i < j; });
        return middle;
    }
};

} // namespace

BoxTree box_tree(std::vector<Aabb> boxes) {
    const auto count = static_cast<uint32_t>(boxes.size());
    if (count == 0) return {};
    BoxTreeBuilder builder{boxes, std::vector<uint32_t>(count), {}};
    std::iota(builder.order.begin(), builder.order.end(), 0U);
    builder.nodes.resize(1);
    builder.build(0, 0, count);
    BoxTree tree{std::move(builder.nodes), {}};
    tree.boxes.reserve(count);
    for (const uint32_t i : builder.order) tree.boxes.push_back(boxes[i]);
    return tree;
}

} // namespace core

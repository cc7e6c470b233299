#pragma once

#include <cstdint>
#include <vector>

#include "core/base/vec.h"

namespace core {

/// A hierarchy over boxes along the axes of one frame. A box may be flat, or a stretch of a line.
struct BoxTree {
    struct Node {
        Aabb box;
        uint32_t first = 0; // leaf: first of `count` boxes; inner: left child, the right follows
        uint32_t count = 0; // 0 for an inner node

        bool is_leaf() const { return count > 0; }
    };
    std::vector<Node> nodes; // root first; empty when there are no boxes
    std::vector<Aabb> boxes; // in the order of the leaves
};

/// Builds the tree: nodes are halved at the median along their longest side, ties by index.
///
/// Cost: O(n log n) time; some 120 bytes per box.
BoxTree box_tree(std::vector<Aabb> boxes);

} // namespace core

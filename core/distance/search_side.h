#pragma once

#include <array>
#include <vector>

#include "core/base/vec.h"
#include "core/distance/closest_pair.h"
#include "core/distance/lane_kernels.h"

namespace core {

/// Three directions at right angles, in which a search compares its boxes. Frame: that of A.
struct SearchFrame {
    std::array<Vec3, 3> directions{};
    Vec3 origin = Vec3(0.0);

    /// A vector along the directions.
    Vec3 along(const Vec3& v) const {
        return {glm::dot(directions[0], v), glm::dot(directions[1], v), glm::dot(directions[2], v)};
    }
};

/// The frame whose first direction is `across` and whose second lies near `along`; for a moving
/// body as near as possible to its way, `sweep`. None needs unit length.
SearchFrame search_frame(const Vec3& across, const Vec3& along, const Vec3& origin,
                         const Vec3& sweep);

/// A node that a search came to, with its children's boxes in the search's frame, over all of B's
/// motion.
struct VisitedNode {
    BoxLanes boxes;
    PointTree::Lanes size; // of the children: the larger one is opened; -1: a leaf
    std::array<uint32_t, PointTree::width> below; // their numbers among the visited, or `none`
    uint32_t count;                               // of the children
    const PointTree::Node* node;
};

/// A leaf that it came to.
struct VisitedLeaf {
    PointLanes points; // where they start
    PointLanes end;    // and where they go; unused where that is the same for all of them
    float margin;      // what rounding may add to a coordinate or take from it
    const PointTree* tree;
    const PointTree::Leaf* leaf;
};

/// Where a point is stored.
struct PointPlace {
    const PointTree* tree = nullptr;
    const PointTree::Leaf* leaf = nullptr;
    uint32_t point = 0; // in the tree's order

    const Vec3& position() const { return tree->points[point]; }
    uint64_t index() const { return tree->index[point]; }
};

/// Where the point with this index is stored.
PointPlace place_of(const PointTree& tree, uint64_t index);

/// One body's part in a search: what was visited of it, in the frame of the search.
class SearchSide {
public:
    static constexpr uint32_t none = 0xFFFF'FFFFU;

    std::vector<VisitedNode> nodes;  // beyond those visited stand those of earlier searches
    std::vector<VisitedLeaf> leaves; // the same

    /// Forgets what was visited, and visits the root. A stands still: `motion` is null.
    void begin(const PointTree& tree, const SearchFrame& frame, const StraightMotion* motion);

    uint32_t child_node(uint32_t at, uint32_t lane);
    const VisitedLeaf& child_leaf(uint32_t at, uint32_t lane);

    FrameBox box(uint32_t at, uint32_t lane) const;

private:
    /// A pose of the body, and the frame's directions in its own frame.
    struct Pose {
        Transform frame_from_body;
        std::array<Vec3, 3> directions;
    };
    /// How a node or leaf is seen in the frame, and what rounding may add, per axis.
    struct Sight {
        FrameView view;
        Float3 base{}, margin{};
    };

    static Pose pose_in(const SearchFrame& frame, const Transform& a_from_body);
    Sight sight(const Pose& pose, const Vec3& origin, float reach) const;
    uint32_t visit(uint32_t number);
    void look_at(VisitedLeaf& leaf) const;

    const LaneKernels* kernels_ = nullptr;
    const PointTree* tree_ = nullptr;
    uint32_t node_count_ = 0, leaf_count_ = 0; // visited
    Pose start_, end_;
    bool spreads_ = false;   // the points do not all go the same way
    Vec3 sweep_ = Vec3(0.0); // along the directions, when they do
    float coarse_ = 0.0F;    // what double precision adds to a margin, for a body far away
};

} // namespace core

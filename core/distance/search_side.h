#pragma once

#include <array>
#include <vector>

#include "core/base/vec.h"
#include "core/distance/closest_pair.h"
#include "core/distance/lane_kernels.h"

namespace core {

/// Three orthogonal directions in which a search compares its boxes. Frame: A's.
struct SearchFrame {
    std::array<Vec3, 3> directions{};
    Vec3 origin = Vec3(0.0);

    /// The components of a vector along the directions.
    Vec3 along(const Vec3& v) const {
        return {glm::dot(directions[0], v), glm::dot(directions[1], v), glm::dot(directions[2], v)};
    }
};

/// The frame whose first direction is `across` and whose second is close to `along`; for a moving
/// body, as close as possible to its displacement `sweep`. The arguments need not have unit length.
SearchFrame search_frame(const Vec3& across, const Vec3& along, const Vec3& origin,
                         const Vec3& sweep);

/// A visited node, with the boxes of its children in the search frame over the whole motion of B.
struct VisitedNode {
    BoxLanes boxes;
    PointTree::Lanes size; // of the children: the larger one is opened first; -1: a leaf
    std::array<uint32_t, PointTree::width>
        below;      // numbers of the children among the visited nodes, or `none`
    uint32_t count; // of the children
    const PointTree::Node* node;
};

/// A visited leaf.
struct VisitedLeaf {
    PointLanes points; // at the start
    float margin;      // bound of the rounding of a coordinate
    const PointTree* tree;
    const PointTree::Leaf* leaf;
};

/// Where a point is stored.
struct PointLocation {
    const PointTree* tree = nullptr;
    const PointTree::Leaf* leaf = nullptr;
    uint32_t point = 0; // in the tree's order

    const Vec3& position() const { return tree->points[point]; }
    uint64_t index() const { return tree->index[point]; }
};

/// Where the point with this index is stored.
PointLocation location_of(const PointTree& tree, uint64_t index);

/// One body in a search: its visited nodes and leaves in the frame of the search.
class SearchSide {
public:
    static constexpr uint32_t none = 0xFFFF'FFFFU;

    std::vector<VisitedNode> nodes;  // entries beyond the visited ones are from earlier searches
    std::vector<VisitedLeaf> leaves; // likewise

    /// Clears the visited nodes and visits the root. `motion` is null for A, which does not move.
    void begin(const PointTree& tree, const SearchFrame& frame, const StraightMotion* motion);

    uint32_t child_node(uint32_t at, uint32_t lane);
    const VisitedLeaf& child_leaf(uint32_t at, uint32_t lane);

    FrameBox box(uint32_t at, uint32_t lane) const;

private:
    /// A pose of the body, and the directions of the frame in the frame of the body.
    struct Pose {
        Transform frame_from_body;
        std::array<Vec3, 3> directions;
    };
    /// The view of a node or leaf in the frame, and the rounding bound per axis.
    struct NodeView {
        FrameView view;
        Float3 base{}, margin{};
    };

    static Pose pose_in(const SearchFrame& frame, const Transform& a_from_body);
    NodeView sight(const Vec3& origin, float reach) const;
    uint32_t visit(uint32_t number);
    void project(VisitedLeaf& leaf) const;

    const LaneKernels* kernels_ = nullptr;
    const PointTree* tree_ = nullptr;
    uint32_t node_count_ = 0, leaf_count_ = 0; // visited
    Pose start_;
    Vec3 sweep_ = Vec3(0.0); // along the directions
    float coarse_ = 0.0F;    // rounding of double precision, for a body far away
};

} // namespace core

#pragma once

#include <array>
#include <cstdint>

#include "core/distance/point_tree.h"

namespace core {

using Float3 = std::array<float, 3>;

inline Float3 single(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// Transforms directions and positions of a body into the frame of a search.
struct FrameView {
    std::array<Float3, 3> direction{}; // of the search frame, in the frame of the body
    Float3 lower{}, upper{};           // added to lower and upper bounds: position, sweep, rounding
};

/// Eight axis-aligned boxes in the frame of a search.
struct alignas(64) BoxLanes {
    std::array<PointTree::Lanes, 3> lower, upper;
};

/// One box in the frame of a search.
struct FrameBox {
    Float3 lower, upper;
};

/// Sixteen points in the frame of a search.
struct alignas(64) PointLanes {
    std::array<std::array<float, PointTree::leaf_size>, 3> at;
};

/// The inner loops of the fast search for the best instruction set of this processor. Each performs
/// the same operations in the same order in every lane, without fused multiply-add: all instruction
/// sets give the same bits.
struct LaneKernels {
    /// The boxes of a node's children in the frame.
    void (*project_boxes)(const PointTree::Node& node, const FrameView& view, BoxLanes& out);

    /// The points of a leaf in the frame; `view.lower` is added.
    void (*project_points)(const PointTree::Leaf& leaf, const FrameView& view, PointLanes& out);

    /// Squared distances of eight boxes to one; returns the lanes below the limit.
    uint32_t (*near_boxes)(const BoxLanes& boxes, const FrameBox& box, float limit_squared,
                           PointTree::Lanes& squared);

    /// Four times the squared distances of the centres of eight boxes from that of one.
    void (*middles_apart)(const BoxLanes& boxes, const FrameBox& box, PointTree::Lanes& squared);

    /// The lanes whose points are within the limit of the box.
    uint32_t (*near_box)(const PointLanes& points, const FrameBox& box, float limit_squared);

    /// For each of the rows (points of B): the points of A within the limit. B's points move by the
    /// sweep; `per_length` is 1 / its squared length, or 0 without a sweep.
    void (*near_points)(const PointLanes& a, const PointLanes& b, uint32_t rows,
                        const Float3& sweep, float per_length, float limit_squared,
                        std::array<uint16_t, PointTree::leaf_size>& columns);
};

/// The kernels to use.
const LaneKernels& lane_kernels();

} // namespace core

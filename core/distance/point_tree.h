#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/base/vec.h"

namespace core {

/// The tree of the fast engine over the points of a body: eight oriented boxes per node, up to
/// sixteen points per leaf.
struct PointTree {
    static constexpr int width = 8;
    static constexpr int leaf_size = 16;
    static constexpr uint32_t leaf_flag = 0x8000'0000U;
    using Lanes = std::array<float, width>;

    /// Up to eight children, in the lanes set in `used`; other lanes hold finite, meaningless
    /// values.
    struct alignas(64) Node {
        std::array<Lanes, 3> centre{};              // of the children's boxes, from `origin`
        std::array<std::array<Lanes, 3>, 3> axis{}; // [which][x, y, z]; of unit length
        std::array<Lanes, 3> half{};                // half sizes along the three axes
        Lanes radius{};                             // of a ball around the centre
        std::array<uint32_t, width> child{};        // a node, or with the flag a leaf
        Vec3 origin = Vec3(0.0);
        float reach = 0.0F; // greatest distance of any box from `origin`
        uint32_t used = 0;
    };

    /// Points in single precision, relative to `origin`; entries beyond `count` repeat the last
    /// one.
    struct alignas(64) Leaf {
        std::array<std::array<float, leaf_size>, 3> position{};
        Vec3 origin = Vec3(0.0);
        float reach = 0.0F;
        uint32_t first = 0; // index in `points`
        uint32_t count = 0;
        std::array<float, 3> normal{}; // the thinnest axis of its box
        std::array<float, 3> along{};  // the longest axis
        float thickness = 0.0F;        // thinnest side over longest; 1 for a single point
    };

    std::vector<Node> nodes; // the root first
    std::vector<Leaf> leaves;
    std::vector<Vec3> points;       // in the order of the leaves
    std::vector<uint64_t> index;    // of each of `points` in the input
    std::vector<uint32_t> position; // the inverse of `index`
    Aabb box;                       // of the points
};

/// An oriented box around points, in single precision: every point p has |axis[k] . (p - origin -
/// centre)| <= half[k], and for any unit vector u |u . (p - origin - centre)| <= sum of half[k]
/// |axis[k] . u|, although the axes are rounded.
struct TurnedBox;

/// Sets the box of a child of a node; `reach` grows with it.
void set_box(PointTree::Node& node, size_t lane, const TurnedBox& box);

/// Builds the tree.
///
/// Errors: as sphere_tree().
/// Cost:   O(n log n) time, some 95 bytes per point.
Result<PointTree> point_tree(std::span<const Vec3> points);

/// A box around points, aligned to their spread, in single precision: every point p has |axis[k] .
/// (p - origin - centre)| <= half[k], and for any unit vector u |u . (p - origin - centre)| <= sum
/// of half[k] |axis[k] . u|, although the axes are rounded.
struct TurnedBox {
    std::array<float, 3> centre{}; // from the origin given
    std::array<std::array<float, 3>, 3> axis{};
    std::array<float, 3> half{};
    float radius = 0.0F; // half the diagonal
};

/// The box of these points: along their principal axes, the axes of the frame, or a mixture of
/// both, whichever has the least surface.
TurnedBox turned_box(std::span<const Vec3> points, const Vec3& origin);

/// An axis-aligned box as a TurnedBox.
TurnedBox turned_box(const Aabb& box, const Vec3& origin);

/// The smallest float that is not less.
inline float rounded_up(double x) {
    const auto f = static_cast<float>(x);
    return static_cast<double>(f) >= x ? f
                                       : std::nextafter(f, std::numeric_limits<float>::infinity());
}

} // namespace core

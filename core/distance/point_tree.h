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

/// The fast engine's hierarchy over the points of a body: eight boxes to a node, each turned as its
/// points lie, up to sixteen points to a leaf.
struct PointTree {
    static constexpr int width = 8;
    static constexpr int leaf_size = 16;
    static constexpr uint32_t leaf_flag = 0x8000'0000U;
    using Lanes = std::array<float, width>;

    /// Up to eight children, in the lanes whose bits are set in `used`; what stands in the other
    /// lanes is finite and means nothing.
    struct alignas(64) Node {
        std::array<Lanes, 3> centre{};              // of the children's boxes, from `origin`
        std::array<std::array<Lanes, 3>, 3> axis{}; // [which][x, y, z]; of unit length
        std::array<Lanes, 3> half{};                // half sizes along the three axes
        Lanes radius{};                             // of a ball about the centre
        std::array<uint32_t, width> child{};        // a node; with the flag, a leaf
        Vec3 origin = Vec3(0.0);
        float reach = 0.0F; // no box reaches farther from `origin`
        uint32_t used = 0;
    };

    /// Points in single precision, from `origin`; the places beyond `count` repeat the last one.
    struct alignas(64) Leaf {
        std::array<std::array<float, leaf_size>, 3> place{};
        Vec3 origin = Vec3(0.0);
        float reach = 0.0F;
        uint32_t first = 0; // in `points`
        uint32_t count = 0;
        std::array<float, 3> normal{}; // the axis along which its box is thinnest
        std::array<float, 3> along{};  // and longest
        float thickness = 0.0F;        // thinnest side over longest; 1 for a single point
    };

    std::vector<Node> nodes; // the root in front
    std::vector<Leaf> leaves;
    std::vector<Vec3> points;    // in the order of the leaves
    std::vector<uint64_t> index; // of `points` among the points given
    std::vector<uint32_t> place; // the other way round
    Aabb box;                    // of the points
};

struct TurnedBox;

/// Gives a child of a node its box; `reach` grows with it.
void set_box(PointTree::Node& node, size_t lane, const TurnedBox& box);

/// Builds the tree.
///
/// Errors: as sphere_tree().
/// Cost:   O(n log n) time, some 95 bytes per point.
Result<PointTree> point_tree(std::span<const Vec3> points);

/// A box round points, turned as they lie, in single precision: every point p has
/// |axis[k] . (p - origin - centre)| <= half[k], and for any unit vector u
/// |u . (p - origin - centre)| <= sum of half[k] |axis[k] . u|, although the axes are rounded.
struct TurnedBox {
    std::array<float, 3> centre{}; // from the origin given
    std::array<std::array<float, 3>, 3> axis{};
    std::array<float, 3> half{};
    float radius = 0.0F; // half the diagonal
};

/// The box of these points: along their principal axes, the axes of the frame, or a mixture of
/// both, whichever has the least surface.
TurnedBox turned_box(std::span<const Vec3> points, const Vec3& origin);

/// The box itself, its axes those of the frame.
TurnedBox turned_box(const Aabb& box, const Vec3& origin);

/// The next float that is not less.
inline float rounded_up(double x) {
    const auto f = static_cast<float>(x);
    return static_cast<double>(f) >= x ? f
                                       : std::nextafter(f, std::numeric_limits<float>::infinity());
}

} // namespace core

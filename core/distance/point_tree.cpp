#include "core/distance/point_tree.h"

#include <algorithm>
#include <cmath>

#include "core/distance/point_check.h"
#include "core/distance/turned_box.h"

namespace core {
namespace {

/// A point on its way into the tree. Single precision decides only who goes where.
struct Loose {
    std::array<float, 3> at;
    uint32_t index;
};

using Group = std::span<Loose>;

/// The direction in which the points spread most, roughly.
std::array<float, 3> widest_direction(Group group) {
    double n = static_cast<double>(group.size());
    std::array<double, 3> sum{};
    std::array<double, 6> square{};
    for (const Loose& p : group) {
        const double x = p.at[0], y = p.at[1], z = p.at[2];
        sum[0] += x, sum[1] += y, sum[2] += z;
        square[0] += x * x, square[1] += y * y, square[2] += z * z;
        square[3] += x * y, square[4] += y * z, square[5] += z * x;
    }
    const double xx = square[0] - sum[0] * sum[0] / n, yy = square[1] - sum[1] * sum[1] / n,
                 zz = square[2] - sum[2] * sum[2] / n, xy = square[3] - sum[0] * sum[1] / n,
                 yz = square[4] - sum[1] * sum[2] / n, zx = square[5] - sum[2] * sum[0] / n;
    // A few steps of power iteration from the axis of largest spread; any direction would do.
    Vec3 d = xx >= yy && xx >= zz ? Vec3(xx, xy, zx)
             : yy >= zz           ? Vec3(xy, yy, yz)
                                  : Vec3(zx, yz, zz);
    for (int i = 0; i < 4; ++i) {
        const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
        if (!(largest > 0.0)) return {1.0F, 0.0F, 0.0F};
        d /= largest;
        d = Vec3(xx * d.x + xy * d.y + zx * d.z, xy * d.x + yy * d.y + yz * d.z,
                 zx * d.x + yz * d.y + zz * d.z);
    }
    const double length = glm::length(d);
    if (!(length > 0.0)) return {1.0F, 0.0F, 0.0F};
    d /= length;
    return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
}

void divide(Group group, size_t middle) {
    const std::array<float, 3> d = widest_direction(group);
    const auto key = [&](const Loose& p) {
        return d[0] * p.at[0] + d[1] * p.at[1] + d[2] * p.at[2];
    };
    std::nth_element(group.begin(), group.begin() + static_cast<std::ptrdiff_t>(middle),
                     group.end(), [&](const Loose& a, const Loose& b) {
                         const float at_a = key(a), at_b = key(b);
                         return at_a != at_b ? at_a < at_b : a.index < b.index;
                     });
}

size_t leaves_for(size_t points) {
    return (points + PointTree::leaf_size - 1) / PointTree::leaf_size;
}

} // namespace

void set_box(PointTree::Node& node, size_t lane, const TurnedBox& box) {
    double away = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        node.centre[k][lane] = box.centre[k];
        node.half[k][lane] = box.half[k];
        for (size_t j = 0; j < 3; ++j) node.axis[k][j][lane] = box.axis[k][j];
        away += static_cast<double>(box.centre[k]) * static_cast<double>(box.centre[k]);
    }
    node.radius[lane] = box.radius;
    node.reach =
        std::max(node.reach, rounded_up(std::sqrt(away) + static_cast<double>(box.radius)));
}

namespace {

class PointTreeBuilder {
public:
    PointTreeBuilder(std::span<const Vec3> points, uint32_t tile)
        : given_(points), tile_(static_cast<uint64_t>(tile) << 32U) {
        for (const Vec3& p : points) tree_.box.extend(p);
        const Vec3 centre = tree_.box.center();
        loose_.reserve(points.size());
        for (size_t i = 0; i < points.size(); ++i) {
            const Vec3 p = points[i] - centre;
            loose_.push_back(
                {{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
                 static_cast<uint32_t>(i)});
        }
        tree_.points.resize(points.size());
        tree_.index.resize(points.size());
        tree_.place.resize(points.size());
        tree_.leaves.reserve(leaves_for(points.size()));
    }

    PointTree build() && {
        add_node(0, loose_.size());
        return std::move(tree_);
    }

private:
    Group group(size_t first, size_t last) { return Group(loose_).subspan(first, last - first); }

    /// Adds the node of a range of points, and all below it; returns its number.
    uint32_t add_node(size_t first, size_t last) {
        const auto id = static_cast<uint32_t>(tree_.nodes.size());
        tree_.nodes.emplace_back();
        // As many children as are needed when all of them but the last are full.
        const size_t leaves = leaves_for(last - first);
        size_t below = 1; // leaves that a child holds at most
        while (below * PointTree::width < leaves) below *= PointTree::width;
        std::vector<size_t> bounds = {first};
        part(first, last, (leaves + below - 1) / below, bounds);

        PointTree::Node node;
        const size_t count = bounds.size() - 1;
        node.used = (1U << count) - 1U;
        for (size_t lane = 0; lane < count; ++lane)
            node.child[lane] = below == 1 ? add_leaf(bounds[lane], bounds[lane + 1])
                                          : add_node(bounds[lane], bounds[lane + 1]);
        set_boxes(node, bounds);
        tree_.nodes[id] = node;
        return id;
    }

    /// Divides a range into `parts` of nearly equal size and appends where each ends.
    void part(size_t first, size_t last, size_t parts, std::vector<size_t>& bounds) {
        if (parts == 1) {
            bounds.push_back(last);
            return;
        }
        const size_t left = parts / 2;
        const size_t middle = (last - first) * left / parts;
        divide(group(first, last), middle);
        part(first, first + middle, left, bounds);
        part(first + middle, last, parts - left, bounds);
    }

    uint32_t add_leaf(size_t first, size_t last) {
        PointTree::Leaf leaf;
        leaf.first = static_cast<uint32_t>(first);
        leaf.count = static_cast<uint32_t>(last - first);
        std::sort(loose_.begin() + static_cast<std::ptrdiff_t>(first),
                  loose_.begin() + static_cast<std::ptrdiff_t>(last),
                  [](const Loose& a, const Loose& b) { return a.index < b.index; });
        Aabb box;
        for (size_t i = first; i < last; ++i) {
            const uint32_t given = loose_[i].index;
            tree_.points[i] = given_[given];
            tree_.index[i] = tile_ | given;
            tree_.place[given] = static_cast<uint32_t>(i);
            box.extend(given_[given]);
        }
        leaf.origin = box.center();
        leaf.reach = rounded_up(0.5 * glm::length(box.size()));
        for (size_t i = 0; i < PointTree::leaf_size; ++i) {
            const Vec3 p = tree_.points[std::min(first + i, last - 1)] - leaf.origin;
            for (int k = 0; k < 3; ++k)
                leaf.place[static_cast<size_t>(k)][i] = static_cast<float>(p[k]);
        }
        tree_.leaves.push_back(leaf);
        return static_cast<uint32_t>(tree_.leaves.size() - 1) | PointTree::leaf_flag;
    }

    void set_boxes(PointTree::Node& node, const std::vector<size_t>& bounds) {
        const std::span<const Vec3> points(tree_.points);
        const auto all = points.subspan(bounds.front(), bounds.back() - bounds.front());
        Aabb box;
        for (const Vec3& p : all) box.extend(p);
        node.origin = box.center();
        for (size_t lane = 0; lane + 1 < bounds.size(); ++lane) {
            const TurnedBox turned = turned_box(
                points.subspan(bounds[lane], bounds[lane + 1] - bounds[lane]), node.origin);
            set_box(node, lane, turned);
            if ((node.child[lane] & PointTree::leaf_flag) != 0)
                set_lie(tree_.leaves[node.child[lane] & ~PointTree::leaf_flag], turned);
        }
    }

    static void set_lie(PointTree::Leaf& leaf, const TurnedBox& box) {
        const auto [thin, wide] = std::minmax_element(box.half.begin(), box.half.end());
        leaf.normal = box.axis[static_cast<size_t>(thin - box.half.begin())];
        leaf.along = box.axis[static_cast<size_t>(wide - box.half.begin())];
        leaf.thickness = *wide > 0.0F ? *thin / *wide : 1.0F;
    }

    std::span<const Vec3> given_;
    uint64_t tile_;
    std::vector<Loose> loose_;
    PointTree tree_;
};

} // namespace

Result<PointTree> point_tree(std::span<const Vec3> points, uint32_t tile) {
    FEELER_TRY([[maybe_unused]] const size_t count, checked_points(points));
    return PointTreeBuilder(points, tile).build();
}

} // namespace core

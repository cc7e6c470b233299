#include "core/distance/point_tree.h"

#include <algorithm>
#include <cmath>

#include "core/distance/rounding.h"

namespace core {
namespace {

/// A point during the build. Single precision only affects the partition.
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
    // A few steps of power iteration from the axis of largest spread; any direction will do.
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
    explicit PointTreeBuilder(std::span<const Vec3> points) : given_(points) {
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
        tree_.position.resize(points.size());
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
        // As many children as needed if all but the last are full.
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

    /// Divides a range into `parts` ranges of nearly equal size and appends the end of each.
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
            tree_.index[i] = given;
            tree_.position[given] = static_cast<uint32_t>(i);
            box.extend(given_[given]);
        }
        leaf.origin = box.center();
        leaf.reach = rounded_up(0.5 * glm::length(box.size()));
        for (size_t i = 0; i < PointTree::leaf_size; ++i) {
            const Vec3 p = tree_.points[std::min(first + i, last - 1)] - leaf.origin;
            for (int k = 0; k < 3; ++k)
                leaf.position[static_cast<size_t>(k)][i] = static_cast<float>(p[k]);
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
    std::vector<Loose> loose_;
    PointTree tree_;
};

} // namespace

Result<PointTree> point_tree(std::span<const Vec3> points) {
    FEELER_TRY([[maybe_unused]] const size_t count, checked_points(points));
    return PointTreeBuilder(points).build();
}

namespace {

using Axes = std::array<Vec3, 3>;

struct Extent {
    std::array<double, 3> lower, upper;
};

Vec3 to_single(const Vec3& v) { return Vec3(glm::vec3(v)); }

Axes rounded(const Axes& axes) {
    return {to_single(axes[0]), to_single(axes[1]), to_single(axes[2])};
}

/// Eigenvectors of the points' scatter matrix, largest eigenvalue first, by Jacobi rotations.
Axes principal_axes(std::span<const Vec3> points) {
    Vec3 mean(0.0);
    for (const Vec3& p : points) mean += p - points[0];
    mean = points[0] + mean / static_cast<double>(points.size());
    std::array<std::array<double, 3>, 3> m{};
    for (const Vec3& p : points) {
        const Vec3 d = p - mean;
        m[0][0] += d.x * d.x, m[1][1] += d.y * d.y, m[2][2] += d.z * d.z;
        m[0][1] += d.x * d.y, m[1][2] += d.y * d.z, m[0][2] += d.z * d.x;
    }
    m[1][0] = m[0][1], m[2][1] = m[1][2], m[2][0] = m[0][2];
    Axes axes = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    for (int step = 0; step < 12; ++step) {
        const size_t p = step % 3 == 2 ? 1 : 0, q = step % 3 == 0 ? 1 : 2;
        if (std::abs(m[p][q]) <= 1e-14 * (m[0][0] + m[1][1] + m[2][2])) continue;
        const double theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
        const double t =
            (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
        const size_t r = 3 - p - q;
        const double mpp = m[p][p], mqq = m[q][q], mpq = m[p][q], mrp = m[r][p], mrq = m[r][q];
        m[p][p] = mpp - t * mpq, m[q][q] = mqq + t * mpq;
        m[p][q] = m[q][p] = 0.0;
        m[r][p] = m[p][r] = c * mrp - s * mrq;
        m[r][q] = m[q][r] = s * mrp + c * mrq;
        const Vec3 ap = axes[p], aq = axes[q];
        axes[p] = c * ap - s * aq;
        axes[q] = s * ap + c * aq;
    }
    std::array<size_t, 3> order = {0, 1, 2};
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return m[a][a] != m[b][b] ? m[a][a] > m[b][b] : a < b; });
    const Vec3 n = glm::normalize(axes[order[2]]);
    const Vec3 first = glm::normalize(axes[order[0]] - glm::dot(axes[order[0]], n) * n);
    return {first, glm::cross(n, first), n};
}

/// The axes rotated about the last one to align the first with the frame.
Axes squared_up(const Axes& axes) {
    const Vec3 n = axes[2];
    const Vec3 a = glm::abs(n);
    const int least = a.x <= a.y && a.x <= a.z ? 0 : a.y <= a.z ? 1 : 2;
    Vec3 along(0.0);
    along[least] = 1.0;
    const Vec3 first = glm::normalize(along - glm::dot(along, n) * n);
    return {first, glm::cross(n, first), n};
}

Extent extent_of(std::span<const Vec3> points, const Vec3& origin, const Axes& axes) {
    Extent e{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (const Vec3& p : points) {
        const Vec3 d = p - origin;
        for (size_t k = 0; k < 3; ++k) {
            const double x = glm::dot(axes[k], d);
            e.lower[k] = std::min(e.lower[k], x);
            e.upper[k] = std::max(e.upper[k], x);
        }
    }
    return e;
}

double surface(const Extent& e) {
    const double a = e.upper[0] - e.lower[0], b = e.upper[1] - e.lower[1],
                 c = e.upper[2] - e.lower[2];
    return a * b + b * c + c * a;
}

TurnedBox box_of(const Extent& e, const Axes& axes) {
    Vec3 centre(0.0);
    for (size_t k = 0; k < 3; ++k) centre += 0.5 * (e.lower[k] + e.upper[k]) * axes[k];
    centre = to_single(centre);
    TurnedBox box;
    std::array<double, 3> half{};
    for (size_t k = 0; k < 3; ++k) {
        const double at = glm::dot(axes[k], centre);
        half[k] = std::max({e.upper[k] - at, at - e.lower[k], 0.0});
    }
    const double radius = std::sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
    for (size_t k = 0; k < 3; ++k) {
        // Rounded axes are orthonormal to 4e-7, so the error of a projection is at most that
        // fraction of the radius. Adding this amount on each axis covers it, because |u . axis| add
        // up to at least 1.
        box.half[k] = rounded_up(half[k] + 1e-6 * radius);
        box.centre[k] = static_cast<float>(centre[static_cast<int>(k)]);
        for (int j = 0; j < 3; ++j)
            box.axis[k][static_cast<size_t>(j)] = static_cast<float>(axes[k][j]);
    }
    box.radius = rounded_up(radius * (1.0 + 1e-6));
    return box;
}

} // namespace

TurnedBox turned_box(const Aabb& box, const Vec3& origin) {
    const Vec3 lower = box.min - origin, upper = box.max - origin;
    return box_of({{lower.x, lower.y, lower.z}, {upper.x, upper.y, upper.z}},
                  {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)});
}

TurnedBox turned_box(std::span<const Vec3> points, const Vec3& origin) {
    const Axes principal = principal_axes(points);
    Axes best = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    Extent extent = extent_of(points, origin, best);
    for (const Axes& candidate : {rounded(principal), rounded(squared_up(principal))}) {
        const Extent other = extent_of(points, origin, candidate);
        if (surface(other) < surface(extent)) {
            extent = other;
            best = candidate;
        }
    }
    return box_of(extent, best);
}

} // namespace core

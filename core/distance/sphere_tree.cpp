#include "core/distance/sphere_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/distance/point_check.h"

namespace core {
namespace {

int longest_axis(const Vec3& size) {
    if (size.x >= size.y && size.x >= size.z) return 0;
    return size.y >= size.z ? 1 : 2;
}

class SphereTreeBuilder {
public:
    explicit SphereTreeBuilder(std::span<const Vec3> points)
        : points_(points), order_(points.size()), leaf_of_point_(points.size()) {
        std::iota(order_.begin(), order_.end(), uint32_t{0});
        nodes_.reserve(2 * points.size() - 1);
    }

    SphereTree build() && {
        add(order_);
        return {std::move(nodes_), std::move(leaf_of_point_)};
    }

private:
    /// Adds the node of these points, and all below it. Halving the points keeps the depth
    /// under 33.
    void add(std::span<uint32_t> group) {
        Aabb box;
        for (const uint32_t i : group) box.extend(points_[i]);
        const size_t node = nodes_.size();
        nodes_.push_back({.centre = box.center()});
        if (group.size() == 1) {
            nodes_[node] = {.centre = points_[group[0]], .point = group[0]};
            leaf_of_point_[group[0]] = static_cast<uint32_t>(node);
            return;
        }
        nodes_[node].radius = radius_about(nodes_[node].centre, group);
        const size_t half = group.size() / 2;
        split(group, half, longest_axis(box.size()));
        add(group.first(half));
        nodes_[node].right = static_cast<uint32_t>(nodes_.size());
        add(group.subspan(half));
    }

    double radius_about(const Vec3& centre, std::span<const uint32_t> group) const {
        double squared = 0.0;
        for (const uint32_t i : group) {
            const Vec3 d = points_[i] - centre;
            squared = std::max(squared, glm::dot(d, d));
        }
        return std::sqrt(squared);
    }

    void split(std::span<uint32_t> group, size_t half, int axis) const {
        const auto middle = group.begin() + static_cast<std::ptrdiff_t>(half);
        std::nth_element(group.begin(), middle, group.end(), [&](uint32_t a, uint32_t b) {
            const double at_a = points_[a][axis], at_b = points_[b][axis];
            return at_a != at_b ? at_a < at_b : a < b;
        });
        // nth_element fixes who is in which half, not their order; radii and boxes depend on the
        // former only.
    }

    std::span<const Vec3> points_;
    std::vector<uint32_t> order_;
    std::vector<uint32_t> leaf_of_point_;
    std::vector<SphereTree::Node> nodes_;
};

} // namespace

Result<SphereTree> sphere_tree(std::span<const Vec3> points) {
    FEELER_TRY([[maybe_unused]] const size_t count, checked_points(points));
    return SphereTreeBuilder(points).build();
}

} // namespace core

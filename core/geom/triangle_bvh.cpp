#include "core/geom/triangle_bvh.h"

#include <algorithm>
#include <numeric>

namespace core {
namespace {

constexpr uint32_t leaf_size = 4;

class Builder {
public:
    explicit Builder(const Mesh& mesh) {
        const auto count = static_cast<uint32_t>(mesh.triangles.size());
        for (uint32_t i = 0; i < count; ++i) bvh_.triangles.push_back(mesh.triangle(i));
        bvh_.ids.resize(count);
        std::iota(bvh_.ids.begin(), bvh_.ids.end(), 0U);
        if (count == 0) return;
        bvh_.nodes.resize(1);
        bvh_.oriented.resize(1);
        build(0, 0, count);
    }

    TriangleBvh take() { return std::move(bvh_); }

private:
    void build(uint32_t node, uint32_t first, uint32_t last) {
        const std::span triangles = std::span(bvh_.triangles).subspan(first, last - first);
        for (const Triangle& t : triangles) bvh_.nodes[node].box.extend(t.bounds());
        bvh_.oriented[node] = fitted_box(triangles);
        if (last - first <= leaf_size) {
            bvh_.nodes[node].first = first;
            bvh_.nodes[node].count = last - first;
            return;
        }
        const uint32_t middle = split(bvh_.oriented[node], first, last);
        const auto child = static_cast<uint32_t>(bvh_.nodes.size());
        bvh_.nodes[node].first = child;
        bvh_.nodes.resize(bvh_.nodes.size() + 2);
        bvh_.oriented.resize(bvh_.nodes.size());
        build(child, first, middle);
        build(child + 1, middle, last);
    }

    /// Halves the range at the median along the longest side of its box; ties go by index.
    uint32_t split(const OrientedBox& box, uint32_t first, uint32_t last) {
        const Vec3& h = box.half;
        const Vec3 axis = box.axes[h.x >= h.y && h.x >= h.z ? 0 : h.y >= h.z ? 1 : 2];
        struct Entry {
            double key;
            uint32_t id;
            Triangle triangle;
        };
        std::vector<Entry> entries;
        for (uint32_t i = first; i < last; ++i) {
            const Triangle& t = bvh_.triangles[i];
            const Aabb b = t.bounds();
            entries.push_back({glm::dot(b.min + b.max, axis), bvh_.ids[i], t});
        }
        const uint32_t half = (last - first) / 2;
        std::nth_element(entries.begin(), entries.begin() + half, entries.end(),
                         [](const Entry& x, const Entry& y) {
                             return x.key != y.key ? x.key < y.key : x.id < y.id;
                         });
        for (uint32_t i = first; i < last; ++i) {
            bvh_.triangles[i] = entries[i - first].triangle;
            bvh_.ids[i] = entries[i - first].id;
        }
        return first + half;
    }

    TriangleBvh bvh_;
};

/// Keeps the best pair, and the least lower bound among all that was looked at.
struct NearestTriangleSearch {
    SeparationGoal goal;
    Separation best;
    double least_lower = infinity;

    double limit() const { return std::min(goal.limit, best.upper); }

    void offer(const Separation& found) {
        least_lower = std::min(least_lower, found.lower);
        if (found.upper < best.upper) best = found;
    }

    Separation result() const {
        const double lower = std::min({least_lower, best.upper, goal.limit});
        Separation found = best.upper < goal.limit ? best : Separation{};
        found.lower = lower;
        return found;
    }
};

struct ShapeSearch : NearestTriangleSearch {
    const ConvexShape& shape;
    const Aabb shape_box;
    const TriangleBvh& mesh;

    ShapeSearch(const ConvexShape& s, const TriangleBvh& m, const SeparationGoal& g)
        : NearestTriangleSearch{g, {}, infinity}, shape(s), shape_box(bounds(s)), mesh(m) {}

    bool worth(const TriangleBvh::Node& node) const {
        if (distance(shape_box, node.box) >= limit()) return false;
        return separation(shape, convex(node.box), {goal.tolerance, limit()}).lower < limit();
    }

    void visit(uint32_t index) {
        const TriangleBvh::Node& node = mesh.nodes[index];
        if (!node.is_leaf()) return visit_children(node.first);
        for (uint32_t i = node.first; i < node.first + node.count; ++i)
            offer(separation(shape, convex(mesh.triangles[i]), {goal.tolerance, limit()}));
    }

    void visit_children(uint32_t first) {
        uint32_t near = first, far = first + 1;
        if (distance(shape_box, mesh.nodes[far].box) < distance(shape_box, mesh.nodes[near].box))
            std::swap(near, far);
        for (const uint32_t child : {near, far})
            if (best.upper > 0.0 && worth(mesh.nodes[child])) visit(child);
    }
};

} // namespace

TriangleBvh build_bvh(const Mesh& mesh) { return Builder(mesh).take(); }

Separation separation(const ConvexShape& shape, const TriangleBvh& mesh,
                      const SeparationGoal& goal) {
    if (mesh.nodes.empty()) return {};
    ShapeSearch search(shape, mesh, goal);
    if (search.worth(mesh.nodes[0])) search.visit(0);
    return search.result();
}

std::vector<uint32_t> triangles_in(const TriangleBvh& mesh, const Aabb& box) {
    std::vector<uint32_t> found;
    std::vector<uint32_t> stack;
    if (!mesh.nodes.empty()) stack.push_back(0);
    while (!stack.empty()) {
        const TriangleBvh::Node& node = mesh.nodes[stack.back()];
        stack.pop_back();
        if (!overlaps(node.box, box)) continue;
        if (!node.is_leaf()) {
            stack.push_back(node.first);
            stack.push_back(node.first + 1);
            continue;
        }
        for (uint32_t i = node.first; i < node.first + node.count; ++i)
            if (overlaps(mesh.triangles[i].bounds(), box)) found.push_back(mesh.ids[i]);
    }
    std::sort(found.begin(), found.end());
    return found;
}

} // namespace core

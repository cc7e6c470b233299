#include "core/geom/triangle_bvh.h"

#include <algorithm>
#include <numeric>

namespace core {
namespace {

constexpr uint32_t leaf_size = 4;

Aabb bounds_of(const Triangle& t) {
    Aabb box;
    for (const Vec3& corner : {t.a, t.b, t.c}) box.extend(corner);
    return box;
}

struct Builder {
    const Mesh& mesh;
    std::vector<Aabb> boxes;
    std::vector<uint32_t> order;
    TriangleBvh bvh;

    void build(uint32_t node, uint32_t first, uint32_t last) {
        Aabb box;
        for (uint32_t i = first; i < last; ++i) box.extend(boxes[order[i]]);
        bvh.nodes[node].box = box;
        if (last - first <= leaf_size) {
            bvh.nodes[node].first = first;
            bvh.nodes[node].count = last - first;
            return;
        }
        const uint32_t middle = split(box, first, last);
        const auto child = static_cast<uint32_t>(bvh.nodes.size());
        bvh.nodes[node].first = child;
        bvh.nodes.resize(bvh.nodes.size() + 2);
        build(child, first, middle);
        build(child + 1, middle, last);
    }

    /// Halves the range at the median along the longest axis; ties go by index.
    uint32_t split(const Aabb& box, uint32_t first, uint32_t last) {
        const Vec3 size = box.size();
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const auto key = [&](uint32_t i) { return boxes[i].min[axis] + boxes[i].max[axis]; };
        const uint32_t middle = first + (last - first) / 2;
        std::nth_element(
            order.begin() + first, order.begin() + middle, order.begin() + last,
            [&](uint32_t i, uint32_t j) { return key(i) != key(j) ? key(i) < key(j) : i < j; });
        return middle;
    }
};

/// Keeps the best pair, and the least lower bound among all that was looked at.
struct Search {
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

struct ShapeSearch : Search {
    const ConvexShape& shape;
    const Aabb shape_box;
    const TriangleBvh& mesh;

    ShapeSearch(const ConvexShape& s, const TriangleBvh& m, const SeparationGoal& g)
        : Search{g, {}, infinity}, shape(s), shape_box(bounds(s)), mesh(m) {}

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

TriangleBvh build_bvh(const Mesh& mesh) {
    const auto count = static_cast<uint32_t>(mesh.triangles.size());
    Builder builder{mesh, {}, std::vector<uint32_t>(count), {}};
    if (count == 0) return {};
    for (uint32_t i = 0; i < count; ++i) builder.boxes.push_back(bounds_of(mesh.triangle(i)));
    std::iota(builder.order.begin(), builder.order.end(), 0U);
    builder.bvh.nodes.resize(1);
    builder.build(0, 0, count);
    for (const uint32_t id : builder.order) builder.bvh.triangles.push_back(mesh.triangle(id));
    builder.bvh.ids = std::move(builder.order);
    return std::move(builder.bvh);
}

Separation separation(const ConvexShape& shape, const TriangleBvh& mesh,
                      const SeparationGoal& goal) {
    if (mesh.nodes.empty()) return {};
    ShapeSearch search(shape, mesh, goal);
    if (search.worth(mesh.nodes[0])) search.visit(0);
    return search.result();
}

Separation separation(const TriangleBvh& a, const TriangleBvh& b, const Transform& a_from_b,
                      std::span<const Vec3> sweep_of_b, const SeparationGoal& goal) {
    Search best{goal, {}, infinity};
    // One triangle of B at a time against the tree of A, nearest boxes first, so that the limit
    // tightens early.
    std::vector<std::pair<double, ConvexShape>> queue;
    if (a.nodes.empty()) return {};
    for (const Triangle& t : b.triangles) {
        const ConvexShape shape =
            swept(convex(Triangle{a_from_b * t.a, a_from_b * t.b, a_from_b * t.c}), sweep_of_b);
        queue.emplace_back(distance(bounds(shape), a.nodes[0].box), shape);
    }
    std::stable_sort(queue.begin(), queue.end(),
                     [](const auto& x, const auto& y) { return x.first < y.first; });
    for (const auto& [bound, shape] : queue) {
        if (bound >= best.limit() || best.best.upper == 0.0) break;
        Separation found = separation(shape, a, {goal.tolerance, best.limit()});
        std::swap(found.point_a, found.point_b);
        best.offer(found);
    }
    return best.result();
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
            if (overlaps(bounds_of(mesh.triangles[i]), box)) found.push_back(mesh.ids[i]);
    }
    std::sort(found.begin(), found.end());
    return found;
}

} // namespace core

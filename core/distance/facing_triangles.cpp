#include "core/distance/facing_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace core {
namespace {

using Vec2 = glm::dvec2;

constexpr uint32_t stack_leaf = 4;

Vec2 seen_along_z(const Vec3& p) { return {p.x, p.y}; }

double cross_of(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

/// A convex polygon: a triangle of which three lines have cut off parts.
struct Overlap {
    std::array<Vec2, 8> points;
    size_t count = 0;

    void add(const Vec2& p) {
        if (count < points.size()) points[count++] = p;
    }
};

/// The part of a polygon on the left of the line from a to b.
Overlap left_of(const Overlap& polygon, const Vec2& a, const Vec2& b) {
    Overlap left;
    for (size_t i = 0; i < polygon.count; ++i) {
        const Vec2& p = polygon.points[i];
        const Vec2& q = polygon.points[(i + 1) % polygon.count];
        const double at_p = cross_of(b - a, p - a), at_q = cross_of(b - a, q - a);
        if (at_p >= 0.0) left.add(p);
        if ((at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0))
            left.add(p + at_p / (at_p - at_q) * (q - p));
    }
    return left;
}

/// The region in which two triangles are above each other.
Overlap overlap_of(const Triangle& a, const Triangle& b) {
    Overlap overlap;
    for (const Vec3& p : {a.a, a.b, a.c}) overlap.add(seen_along_z(p));
    std::array<Vec2, 3> corners = {seen_along_z(b.a), seen_along_z(b.b), seen_along_z(b.c)};
    if (cross_of(corners[1] - corners[0], corners[2] - corners[0]) < 0.0)
        std::swap(corners[1], corners[2]);
    for (size_t k = 0; k < 3; ++k) overlap = left_of(overlap, corners[k], corners[(k + 1) % 3]);
    return overlap;
}

/// Twice the area over the greatest length: at least half of the width and at most the width.
double width_of(const Overlap& overlap) {
    double area = 0.0, longest = 0.0;
    for (size_t i = 0; i < overlap.count; ++i) {
        const Vec2 p = overlap.points[i] - overlap.points[0];
        if (i + 1 < overlap.count) area += cross_of(p, overlap.points[i + 1] - overlap.points[0]);
        for (size_t k = 0; k < i; ++k)
            longest = std::max(longest, glm::distance(overlap.points[i], overlap.points[k]));
    }
    return longest > 0.0 ? std::abs(area) / longest : 0.0;
}

/// The height of a triangle at a place that it covers, seen along Z.
double height_at(const Triangle& t, const Vec2& p) {
    const Vec2 a = seen_along_z(t.a), b = seen_along_z(t.b), c = seen_along_z(t.c);
    const double all = cross_of(b - a, c - a);
    const double of_b = cross_of(p - a, c - a) / all, of_c = cross_of(b - a, p - a) / all;
    const double height = t.a.z + of_b * (t.b.z - t.a.z) + of_c * (t.c.z - t.a.z);
    // A steep triangle magnifies rounding, but not beyond its corners.
    return std::clamp(height, std::min({t.a.z, t.b.z, t.c.z}), std::max({t.a.z, t.b.z, t.c.z}));
}

} // namespace

std::vector<Triangle> facing_triangles(const Mesh& mesh, const Transform& travel_from_mesh, bool up,
                                       double graze) {
    std::vector<Vec3> vertices;
    vertices.reserve(mesh.vertices.size());
    for (const Vec3& v : mesh.vertices) vertices.push_back(travel_from_mesh * v);
    std::vector<Triangle> facing;
    for (const Mesh::Corners& t : mesh.triangles) {
        const Triangle triangle{vertices[t[0]], vertices[t[1]], vertices[t[2]]};
        const Vec2 a = seen_along_z(triangle.a), b = seen_along_z(triangle.b),
                   c = seen_along_z(triangle.c);
        const double area = cross_of(b - a, c - a) * (up ? 1.0 : -1.0);
        const double longest =
            std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
        if (area > graze * longest) facing.push_back(triangle);
    }
    return facing;
}

std::optional<double> way_between(const Triangle& moving, const Triangle& fixed, double graze,
                                  double sunk) {
    const Overlap overlap = overlap_of(moving, fixed);
    if (!(width_of(overlap) > graze)) return std::nullopt;
    double least = infinity, most = -infinity;
    for (size_t i = 0; i < overlap.count; ++i) {
        // The gap is linear in the region, so its extremes are at corners.
        const double gap =
            height_at(fixed, overlap.points[i]) - height_at(moving, overlap.points[i]);
        least = std::min(least, gap);
        most = std::max(most, gap);
    }
    if (most < -sunk) return std::nullopt;
    return std::max(least, 0.0);
}

TriangleStack::TriangleStack(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
    if (triangles_.empty()) return;
    nodes_.emplace_back();
    divide(0, 0, static_cast<uint32_t>(triangles_.size()));
}

void TriangleStack::divide(uint32_t node, uint32_t first, uint32_t count) {
    Aabb box;
    for (uint32_t i = first; i < first + count; ++i) box.extend(triangles_[i].bounds());
    nodes_[node].box = box;
    if (count <= stack_leaf) {
        nodes_[node].first = first;
        nodes_[node].count = count;
        return;
    }
    const int axis = box.size().x >= box.size().y ? 0 : 1;
    const auto middle = [&](const Triangle& t) { return t.a[axis] + t.b[axis] + t.c[axis]; };
    const auto begin = triangles_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
                     [&](const Triangle& a, const Triangle& b) { return middle(a) < middle(b); });
    const auto children = static_cast<uint32_t>(nodes_.size());
    nodes_[node].first = children;
    nodes_.resize(nodes_.size() + 2);
    divide(children, first, count / 2);
    divide(children + 1, first + count / 2, count - count / 2);
}

void TriangleStack::for_each_above(const Aabb& box, double sunk,
                                   const std::function<double()>& limit,
                                   const std::function<void(const Triangle&)>& visit) const {
    const auto matters = [&](const Aabb& b) {
        return b.min.x <= box.max.x && box.min.x <= b.max.x && b.min.y <= box.max.y
               && box.min.y <= b.max.y && b.max.z >= box.min.z - sunk
               && b.min.z - box.max.z < limit();
    };
    std::vector<uint32_t> open;
    if (!nodes_.empty()) open.push_back(0);
    while (!open.empty()) {
        const Node& node = nodes_[open.back()];
        open.pop_back();
        if (!matters(node.box)) continue;
        for (uint32_t i = node.first; i < node.first + node.count; ++i)
            if (matters(triangles_[i].bounds())) visit(triangles_[i]);
        if (node.count > 0) continue;
        // The lower one first: its gap is likely to be less.
        const bool swap = nodes_[node.first].box.min.z < nodes_[node.first + 1].box.min.z;
        open.push_back(swap ? node.first + 1 : node.first);
        open.push_back(swap ? node.first : node.first + 1);
    }
}

} // namespace core

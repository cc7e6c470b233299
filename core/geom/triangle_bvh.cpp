#include "core/geom/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace core {
namespace {

/// Covers rounding in the box, as a fraction of the coordinates: see README.md, "Boxes".
constexpr double rounding = 1e-14;

Aabb bounds_of(std::span<const Triangle> triangles) {
    Aabb box;
    for (const Triangle& t : triangles)
        for (const Vec3& p : {t.a, t.b, t.c}) box.extend(p);
    return box;
}

/// Second moments of the area about a point, up to a constant factor.
Mat3 moments(std::span<const Triangle> triangles, const Vec3& about) {
    Mat3 sum(0.0);
    double area = 0.0;
    Vec3 first(0.0);
    for (const Triangle& t : triangles) {
        const Vec3 a = t.a - about, b = t.b - about, c = t.c - about;
        const double weight = glm::length(glm::cross(b - a, c - a));
        const Vec3 middle = a + b + c;
        sum += weight
               * (glm::outerProduct(middle, middle) + glm::outerProduct(a, a)
                  + glm::outerProduct(b, b) + glm::outerProduct(c, c));
        first += weight * middle;
        area += weight;
    }
    if (area == 0.0) return Mat3(0.0);
    return sum - (4.0 / 3.0 / area) * glm::outerProduct(first, first);
}

/// The eigenvectors of a symmetric matrix, by Jacobi rotations.
Mat3 eigenvectors(Mat3 m) {
    Mat3 vectors(1.0);
    for (int sweep = 0; sweep < 12; ++sweep)
        for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
            const double off = m[p][q];
            if (std::abs(off) <= 1e-18 * (std::abs(m[p][p]) + std::abs(m[q][q]))) continue;
            const double theta = (m[q][q] - m[p][p]) / (2.0 * off);
            const double tangent =
                (theta < 0.0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
            const double c = 1.0 / std::sqrt(tangent * tangent + 1.0), s = tangent * c;
            Mat3 turn(1.0);
            turn[p][p] = turn[q][q] = c;
            turn[q][p] = s;
            turn[p][q] = -s;
            m = glm::transpose(turn) * m * turn;
            vectors = vectors * turn;
        }
    return vectors;
}

/// Axes along the longest side and the normal of the triangle with the longest side; arbitrary if
/// it is degenerate.
Mat3 axes_along_side(std::span<const Triangle> triangles) {
    Vec3 longest(0.0), normal(0.0);
    for (const Triangle& t : triangles)
        for (const Vec3& side : {t.b - t.a, t.c - t.b, t.a - t.c}) {
            if (glm::dot(side, side) <= glm::dot(longest, longest)) continue;
            longest = side;
            normal = glm::cross(t.b - t.a, t.c - t.a);
        }
    return Mat3(longest, normal, Vec3(0.0));
}

/// Gram-Schmidt on the first two columns, twice: after one pass a short second column may still be
/// inaccurate.
Mat3 at_right_angles(Mat3 m) {
    for (int pass = 0; pass < 2; ++pass) {
        const Vec3 x = glm::normalize(m[0]);
        const Vec3 y = glm::normalize(m[1] - glm::dot(m[1], x) * x);
        m = Mat3(x, y, glm::cross(x, y));
    }
    return m;
}

OrientedBox box_along(const Mat3& axes, std::span<const Triangle> triangles, const Vec3& about) {
    Aabb local;
    for (const Triangle& t : triangles)
        for (const Vec3& p : {t.a, t.b, t.c}) local.extend((p - about) * axes);
    return {about + axes * local.center(), axes, 0.5 * local.size()};
}

double surface(const OrientedBox& box) {
    const Vec3& h = box.half;
    return h.x * h.y + h.y * h.z + h.z * h.x;
}

} // namespace

double lean(const Mat3& m) {
    const Mat3 off = glm::transpose(m) * m - Mat3(1.0);
    double sum = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) sum += std::abs(off[i][j]);
    return sum;
}

OrientedBox fitted_box(std::span<const Triangle> triangles) {
    const Aabb bounds = bounds_of(triangles);
    const Vec3 about = bounds.center();
    OrientedBox best{about, Mat3(1.0), 0.5 * bounds.size()};
    const std::array<Mat3, 2> guesses = {eigenvectors(moments(triangles, about)),
                                         axes_along_side(triangles)};
    for (const Mat3& guess : guesses) {
        const Mat3 axes = at_right_angles(guess);
        if (!(lean(axes) <= box_lean)) continue; // not a number where a column had no length
        const OrientedBox box = box_along(axes, triangles, about);
        if (surface(box) < surface(best)) best = box;
    }
    const Vec3 farthest = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
    best.half += rounding * (farthest.x + farthest.y + farthest.z);
    return best;
}

double distance_bound(const OrientedBox& a, const OrientedBox& b, const Vec3& sweep) {
    const Vec3 half_sweep = 0.5 * sweep;
    const Vec3 apart = b.center + half_sweep - a.center;
    // Written out: this is where searches spend their time, and glm's products cost twice as much.
    double reach_a[3] = {a.half.x, a.half.y, a.half.z}; // sum of both half extents along A's axes
    double square_b = 0.0;
    for (int j = 0; j < 3; ++j) {
        const Vec3& axis = b.axes[j];
        double reach_b = b.half[j];
        for (int i = 0; i < 3; ++i) {
            const double turn = std::abs(glm::dot(a.axes[i], axis));
            reach_a[i] += turn * b.half[j];
            reach_b += turn * a.half[i];
        }
        const double gap =
            std::abs(glm::dot(apart, axis)) - std::abs(glm::dot(half_sweep, axis)) - reach_b;
        square_b += gap > 0.0 ? gap * gap : 0.0;
    }
    double square_a = 0.0;
    for (int i = 0; i < 3; ++i) {
        const Vec3& axis = a.axes[i];
        const double gap =
            std::abs(glm::dot(apart, axis)) - std::abs(glm::dot(half_sweep, axis)) - reach_a[i];
        square_a += gap > 0.0 ? gap * gap : 0.0;
    }
    return std::sqrt(std::max(square_a, square_b));
}

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

/// Keeps the best pair and the least lower bound of all examined triangles.
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

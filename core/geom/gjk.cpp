#include "core/geom/gjk.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/math.h"
#include "core/geom/mesh.h"

namespace core {
namespace {

/// Farthest point of an upright truncated cone about Z.
Vec3 cone_support(const ProfileElement& cone, const Vec3& direction) {
    const double across = std::sqrt(direction.x * direction.x + direction.y * direction.y);
    const double lower = cone.r0 * across + cone.z0 * direction.z;
    const double upper = cone.r1 * across + cone.z1 * direction.z;
    const double r = upper > lower ? cone.r1 : cone.r0;
    const double z = upper > lower ? cone.z1 : cone.z0;
    if (across == 0.0) return {r, 0.0, z};
    return {direction.x * (r / across), direction.y * (r / across), z};
}

Vec3 core_support(const ConvexShape& shape, const Vec3& direction) {
    if (shape.core == ConvexShape::Core::cone) {
        if (shape.upright) return cone_support(shape.cone, direction);
        const Vec3 local = glm::transpose(shape.orientation) * direction;
        return shape.orientation * cone_support(shape.cone, local);
    }
    size_t best = 0;
    double farthest = glm::dot(shape.points[0], direction);
    for (size_t i = 1; i < shape.point_count; ++i) {
        const double along = glm::dot(shape.points[i], direction);
        if (along <= farthest) continue;
        farthest = along;
        best = i;
    }
    return shape.points[best];
}

} // namespace

ConvexShape convex(const Triangle& triangle) {
    ConvexShape shape;
    shape.point_count = 3;
    shape.points[0] = triangle.a;
    shape.points[1] = triangle.b;
    shape.points[2] = triangle.c;
    return shape;
}

ConvexShape convex(const Aabb& box) {
    ConvexShape shape;
    shape.point_count = 8;
    for (size_t i = 0; i < 8; ++i)
        shape.points[i] = {i & 1U ? box.max.x : box.min.x, i & 2U ? box.max.y : box.min.y,
                           i & 4U ? box.max.z : box.min.z};
    return shape;
}

ConvexShape convex_segment(const Vec3& a, const Vec3& b) {
    ConvexShape shape;
    shape.point_count = 2;
    shape.points[0] = a;
    shape.points[1] = b;
    return shape;
}

ConvexShape convex(const ProfileElement& element) {
    ConvexShape shape;
    shape.margin = element.margin;
    if (element.r0 == 0.0 && element.r1 == 0.0) { // a ball, or the sweep of one along its axis
        shape.point_count = 2;
        shape.points[0] = {0.0, 0.0, element.z0};
        shape.points[1] = {0.0, 0.0, element.z1};
        return shape;
    }
    shape.core = ConvexShape::Core::cone;
    shape.cone = element;
    return shape;
}

ConvexShape convex_sphere(double radius) {
    ConvexShape shape;
    shape.point_count = 1;
    shape.margin = radius;
    return shape;
}

ConvexShape posed(const ConvexShape& shape, const Transform& target_from_shape) {
    assert(shape.position_count == 1);
    ConvexShape result = shape;
    for (size_t i = 0; i < shape.point_count; ++i)
        result.points[i] = target_from_shape.rotation * shape.points[i];
    result.orientation = target_from_shape.rotation * shape.orientation;
    result.upright = result.orientation == Mat3(1.0);
    result.positions[0].at = target_from_shape * shape.positions[0].at;
    return result;
}

ConvexShape swept(const ConvexShape& shape, std::span<const Vec3> positions) {
    assert(!positions.empty() && positions.size() <= ConvexShape::max_positions
           && shape.position_count == 1);
    ConvexShape result = shape;
    result.position_count = static_cast<uint8_t>(positions.size());
    const double last = std::max<double>(1.0, static_cast<double>(positions.size()) - 1.0);
    for (size_t i = 0; i < positions.size(); ++i)
        result.positions[i] = {shape.positions[0].at + positions[i], static_cast<double>(i) / last};
    return result;
}

SupportPoint support(const ConvexShape& shape, const Vec3& direction) {
    size_t best = 0;
    double farthest = glm::dot(shape.positions[0].at, direction);
    for (size_t i = 1; i < shape.position_count; ++i) {
        const double along = glm::dot(shape.positions[i].at, direction);
        if (along <= farthest) continue;
        farthest = along;
        best = i;
    }
    return {core_support(shape, direction) + shape.positions[best].at, shape.positions[best].time};
}

Aabb bounds(const ConvexShape& shape) {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 direction(0.0);
        direction[axis] = 1.0;
        box.max[axis] = support(shape, direction).point[axis] + shape.margin;
        box.min[axis] = support(shape, -direction).point[axis] - shape.margin;
    }
    return box;
}

namespace {

constexpr int max_steps = 100;

/// Bodies closer than this touch: rounding moves a point of the simplex that should be the origin.
constexpr double gjk_touching = 1e-10;

Simplex::Vertex support_pair(const ConvexShape& a, const ConvexShape& b, const Vec3& towards_a) {
    // The vertex of A - B nearest to the origin along the search direction.
    const SupportPoint on_a = support(a, -towards_a);
    const SupportPoint on_b = support(b, towards_a);
    return {on_a.point - on_b.point, on_a.point, on_b.point, on_a.time, 1.0};
}

bool already_in(const Simplex& simplex, const Simplex::Vertex& vertex) {
    for (size_t i = 0; i < static_cast<size_t>(simplex.count); ++i)
        if (simplex.vertices[i].difference == vertex.difference) return true;
    return false;
}

/// The nearest point of the simplex as a vertex; it is also a point of A - B.
Simplex::Vertex nearest_vertex(const Simplex& simplex) {
    Simplex::Vertex sum{Vec3(0.0), Vec3(0.0), Vec3(0.0), 0.0, 1.0};
    for (size_t i = 0; i < static_cast<size_t>(simplex.count); ++i) {
        const Simplex::Vertex& vertex = simplex.vertices[i];
        sum.difference += vertex.weight * vertex.difference;
        sum.on_a += vertex.weight * vertex.on_a;
        sum.on_b += vertex.weight * vertex.on_b;
        sum.time_a += vertex.weight * vertex.time_a;
    }
    return sum;
}

/// Adds `w` to the simplex and returns its nearest point, closer than `v` if possible.
Vec3 advance(Simplex& simplex, const Simplex::Vertex& w, const Vec3& v) {
    const Simplex before = simplex;
    if (simplex.count < 4 && !already_in(simplex, w)) {
        simplex.vertices[static_cast<size_t>(simplex.count++)] = w;
        const Vec3 next = reduce_to_nearest(simplex);
        if (glm::length(next) < glm::length(v)) return next;
    }
    // The simplex is so flat that its faces are dominated by rounding; the segment from v to w is
    // valid.
    simplex.vertices[0] = nearest_vertex(before);
    simplex.vertices[1] = w;
    simplex.count = 2;
    return reduce_to_nearest(simplex);
}

/// The pair of points for the nearest point of the simplex, moved out by the margins.
void set_witness(Separation& found, const Simplex& simplex, const Vec3& v, double margin_a,
                 double margin_b) {
    const Simplex::Vertex nearest = nearest_vertex(simplex);
    found.point_a = nearest.on_a;
    found.point_b = nearest.on_b;
    found.time_a = std::clamp(nearest.time_a, 0.0, 1.0); // the weights sum to 1 but for rounding
    const double length = glm::length(v);
    if (length <= margin_a + margin_b) { // overlap: any point between the cores is in both
        const double fraction = margin_a + margin_b > 0.0 ? margin_a / (margin_a + margin_b) : 0.0;
        found.point_a = found.point_b = found.point_a + fraction * (found.point_b - found.point_a);
        return;
    }
    found.point_a -= (margin_a / length) * v;
    found.point_b += (margin_b / length) * v;
}

Separation search(const ConvexShape& a, const ConvexShape& b, const SeparationGoal& goal) {
    const double margins = a.margin + b.margin;
    Separation found;
    found.lower = 0.0;

    Simplex simplex;
    simplex.vertices[0] =
        support_pair(a, b, a.positions[0].at - b.positions[0].at + Vec3(0.1, 0.2, 0.3));
    simplex.count = 1;
    Vec3 v = reduce_to_nearest(simplex);

    for (int step = 0; step < max_steps; ++step) {
        const double length = glm::length(v);
        const double upper = length - margins <= gjk_touching ? 0.0 : length - margins;
        if (upper < found.upper) {
            found.upper = upper;
            set_witness(found, simplex, v, a.margin, b.margin);
        }
        if (found.upper == 0.0 || found.upper < goal.enough) break;

        // All of A - B lies beyond the plane through w perpendicular to v: a bound for any v.
        const Simplex::Vertex w = support_pair(a, b, v);
        found.lower = std::max(found.lower, glm::dot(v, w.difference) / length - margins);
        if (found.lower >= goal.limit || found.upper - found.lower <= goal.tolerance) break;
        const Vec3 next = advance(simplex, w, v);
        if (!(glm::length(next) < length)) break;
        v = next;
    }
    found.lower = std::min(found.lower, found.upper);
    return found;
}

/// Where bodies almost touch, the vector between them is dominated by rounding and gives no
/// direction. If one body is moved back by a step, the vector has a direction: the nearest points
/// found there are also points of the bodies here, and their direction gives a plane. Each
/// iteration improves the direction: on a surface of radius R its angle error is multiplied by step
/// / R.
void step_back(const ConvexShape& a, const ConvexShape& b, const SeparationGoal& goal,
               Separation& found) {
    const double step =
        0.001 * std::min(glm::length(bounds(a).size()), glm::length(bounds(b).size()));
    if (!(found.upper < 0.1 * step)) return;
    Vec3 n = (found.point_a - found.point_b) / found.upper;
    for (int round = 0; round < 30 && found.upper - found.lower > goal.tolerance; ++round) {
        ConvexShape back = b;
        for (size_t i = 0; i < back.position_count; ++i) back.positions[i].at -= step * n;
        Separation seen = search(a, back, {0.0, infinity});
        if (seen.upper == 0.0) return;
        const Vec3 from = n;
        n = (seen.point_a - seen.point_b) / seen.upper;
        seen.point_b += step * from;
        const double upper = glm::distance(seen.point_a, seen.point_b);
        const double lower = glm::dot(n, support_pair(a, b, n).difference) - a.margin - b.margin;
        if (upper < found.upper) {
            found.upper = upper <= gjk_touching ? 0.0 : upper;
            found.point_a = seen.point_a;
            found.point_b = found.upper == 0.0 ? seen.point_a : seen.point_b;
            found.time_a = seen.time_a;
        }
        found.lower = std::min(std::max(found.lower, lower), found.upper);
    }
}

} // namespace

Separation separation(const ConvexShape& a, const ConvexShape& b, const SeparationGoal& goal) {
    Separation found = search(a, b, goal);
    const bool is_done = found.lower >= goal.limit || found.upper < goal.enough
                         || found.upper - found.lower <= std::max(goal.tolerance, gjk_touching);
    if (!is_done) step_back(a, b, goal, found);
    return found;
}

namespace {

/// Weights of the point of a face, edge or corner that is nearest to the origin; up to three are
/// used.
struct Nearest {
    std::array<int, 3> index{};
    std::array<double, 3> weight{};
    int count = 0;
    Vec3 point = Vec3(0.0);
};

Nearest corner(const Simplex& s, int i) {
    return {{i, 0, 0}, {1.0, 0.0, 0.0}, 1, s.vertices[static_cast<size_t>(i)].difference};
}

Nearest nearest_on_edge(const Simplex& s, int i, int j) {
    const Vec3 a = s.vertices[static_cast<size_t>(i)].difference;
    const Vec3 b = s.vertices[static_cast<size_t>(j)].difference;
    const Vec3 ab = b - a;
    const double along = -glm::dot(a, ab);
    const double length = glm::dot(ab, ab);
    if (along <= 0.0 || length == 0.0) return corner(s, i);
    if (along >= length) return corner(s, j);
    const double t = along / length;
    return {{i, j, 0}, {1.0 - t, t, 0.0}, 2, a + t * ab};
}

bool nearer(const Nearest& a, const Nearest& b) {
    return glm::dot(a.point, a.point) < glm::dot(b.point, b.point);
}

Nearest nearest_on_face(const Simplex& s, int i, int j, int k) {
    const Vec3 a = s.vertices[static_cast<size_t>(i)].difference;
    const Vec3 b = s.vertices[static_cast<size_t>(j)].difference;
    const Vec3 c = s.vertices[static_cast<size_t>(k)].difference;
    const Vec3 normal = glm::cross(b - a, c - a);
    const double area = glm::dot(normal, normal);
    // Barycentric coordinates of the origin's projection; all positive means it lies in the face.
    const double u = glm::dot(glm::cross(b, c), normal);
    const double v = glm::dot(glm::cross(c, a), normal);
    const double w = glm::dot(glm::cross(a, b), normal);
    if (area > 0.0 && u > 0.0 && v > 0.0 && w > 0.0) {
        const double sum = u + v + w;
        Nearest inside{{i, j, k}, {u / sum, v / sum, w / sum}, 3, {}};
        inside.point = inside.weight[0] * a + inside.weight[1] * b + inside.weight[2] * c;
        return inside;
    }
    Nearest best = nearest_on_edge(s, i, j);
    for (const Nearest& edge : {nearest_on_edge(s, j, k), nearest_on_edge(s, i, k)})
        if (nearer(edge, best)) best = edge;
    return best;
}

/// Whether the origin lies in the tetrahedron, borders included, never in a flat one; sets the
/// weights of the origin if it does.
bool hold_origin(Simplex& s) {
    const auto at = [&](size_t i) { return s.vertices[i].difference; };
    const auto volume = [](const Vec3& p, const Vec3& q, const Vec3& r) {
        return glm::dot(p, glm::cross(q, r));
    };
    const Vec3 edges[] = {at(1) - at(0), at(2) - at(0), at(3) - at(0)};
    const double all = volume(edges[0], edges[1], edges[2]);
    const double scale = glm::length(edges[0]) * glm::length(edges[1]) * glm::length(edges[2]);
    if (std::abs(all) <= 1e-12 * scale) return false;
    const double weights[] = {volume(at(1), at(2), at(3)) / all, volume(at(0), at(3), at(2)) / all,
                              volume(at(0), at(1), at(3)) / all, volume(at(0), at(2), at(1)) / all};
    for (const double weight : weights)
        if (!(weight >= 0.0)) return false;
    // For a flat tetrahedron far away these are dominated by rounding. Only the point that they
    // give proves anything.
    const double sum = weights[0] + weights[1] + weights[2] + weights[3];
    Vec3 point(0.0);
    double reach = 0.0;
    for (size_t i = 0; i < 4; ++i) {
        s.vertices[i].weight = weights[i] / sum;
        point += s.vertices[i].weight * at(i);
        reach = std::max(reach, glm::length(at(i)));
    }
    return glm::length(point) <= 1e-13 * reach;
}

Nearest nearest_on_tetrahedron(const Simplex& s) {
    Nearest best = nearest_on_face(s, 0, 1, 2);
    for (const Nearest& face :
         {nearest_on_face(s, 0, 1, 3), nearest_on_face(s, 0, 2, 3), nearest_on_face(s, 1, 2, 3)})
        if (nearer(face, best)) best = face;
    return best;
}

Nearest nearest_of(const Simplex& s) {
    switch (s.count) {
    case 1:
        return corner(s, 0);
    case 2:
        return nearest_on_edge(s, 0, 1);
    case 3:
        return nearest_on_face(s, 0, 1, 2);
    default:
        return nearest_on_tetrahedron(s);
    }
}

} // namespace

Vec3 reduce_to_nearest(Simplex& simplex) {
    if (simplex.count == 4 && hold_origin(simplex)) return Vec3(0.0);
    const Nearest nearest = nearest_of(simplex);
    Simplex kept;
    kept.count = nearest.count;
    for (size_t i = 0; i < static_cast<size_t>(nearest.count); ++i) {
        kept.vertices[i] = simplex.vertices[static_cast<size_t>(nearest.index[i])];
        kept.vertices[i].weight = nearest.weight[i];
    }
    simplex = kept;
    return nearest.point;
}

} // namespace core

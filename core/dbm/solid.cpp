#include "core/dbm/solid.h"

#include "core/base/math.h"
#include "core/dbm/mesh_scan.h"
#include "core/geom/triangle_bvh.h"

namespace core {
namespace {

/// Added to computed heights so that rounding never loses material, mm.
constexpr double rounding = 1e-9;

template <typename... Cases>
struct Overloaded : Cases... {
    using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

Aabb bounds_of(const SolidCylinder& c) {
    Aabb box{c.base - Vec3(c.radius), c.base + Vec3(c.radius)};
    box.min[c.axis] = c.base[c.axis];
    box.max[c.axis] = c.base[c.axis] + c.height;
    return box;
}

IntervalList line_of_box(const Aabb& box, int axis, double u, double v) {
    const int ua = u_axis(axis), va = v_axis(axis);
    if (u < box.min[ua] || u >= box.max[ua] || v < box.min[va] || v >= box.max[va]) return {};
    return IntervalList({box.min[axis], box.max[axis]});
}

IntervalList line_of_cylinder(const SolidCylinder& c, int axis, double u, double v) {
    Vec3 p(0.0);
    p[u_axis(axis)] = u;
    p[v_axis(axis)] = v;
    const Vec3 d = p - c.base;
    if (axis == c.axis) {
        const double away = core::hypot(d[u_axis(axis)], d[v_axis(axis)]);
        if (away >= c.radius) return {};
        return IntervalList({c.base[axis], c.base[axis] + c.height});
    }
    if (d[c.axis] < 0.0 || d[c.axis] >= c.height) return {};
    const double side = d[3 - axis - c.axis];
    const double under = c.radius * c.radius - side * side;
    if (under <= 0.0) return {};
    return IntervalList({c.base[axis] - std::sqrt(under), c.base[axis] + std::sqrt(under)});
}

/// Distance from `x` to the interval lower .. upper.
double outside(double x, double lower, double upper) {
    return std::max({lower - x, x - upper, 0.0});
}

IntervalList column_of_cylinder(const SolidCylinder& c, const Square& s) {
    const double x = outside(c.base.x, s.x0, s.x1), y = outside(c.base.y, s.y0, s.y1);
    if (c.axis == 2) {
        if (core::hypot(x, y) > c.radius) return {};
        return IntervalList({c.base.z, c.base.z + c.height});
    }
    const Aabb box = bounds_of(c);
    if (s.x1 < box.min.x || s.x0 > box.max.x || s.y1 < box.min.y || s.y0 > box.max.y) return {};
    const double side = c.axis == 0 ? y : x;
    const double half = std::sqrt(std::max(0.0, c.radius * c.radius - side * side)) + rounding;
    return IntervalList({c.base.z - half, c.base.z + half});
}

/// The part of a convex polygon where sign * (p[axis] - at) <= 0.
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, int axis, double at, double sign) {
    std::vector<Vec3> kept;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const Vec3& p = polygon[i];
        const Vec3& q = polygon[(i + 1) % polygon.size()];
        const double dp = sign * (p[axis] - at), dq = sign * (q[axis] - at);
        if (dp <= 0.0) kept.push_back(p);
        if ((dp < 0.0 && dq > 0.0) || (dp > 0.0 && dq < 0.0))
            kept.push_back(p + (q - p) * (dp / (dp - dq)));
    }
    return kept;
}

Interval heights_within(const Triangle& t, const Square& s) {
    std::vector<Vec3> polygon = {t.a, t.b, t.c};
    polygon = clipped(polygon, 0, s.x1, 1.0);
    polygon = clipped(polygon, 0, s.x0, -1.0);
    polygon = clipped(polygon, 1, s.y1, 1.0);
    polygon = clipped(polygon, 1, s.y0, -1.0);
    Interval heights{infinity, -infinity};
    for (const Vec3& p : polygon) {
        heights.lower = std::min(heights.lower, p.z - rounding);
        heights.upper = std::max(heights.upper, p.z + rounding);
    }
    return heights;
}

/// The triangles that a line along Z within the square can meet.
Mesh triangles_over(const SolidMesh& solid, const Square& s) {
    const Aabb column{{s.x0, s.y0, -infinity}, {s.x1, s.y1, infinity}};
    Mesh over;
    for (const uint32_t id : triangles_in(*solid.bvh, column)) {
        const Triangle t = solid.mesh->triangle(id);
        const auto first = static_cast<uint32_t>(over.vertices.size());
        over.vertices.insert(over.vertices.end(), {t.a, t.b, t.c});
        over.triangles.push_back({first, first + 1, first + 2});
    }
    return over;
}

IntervalList column_of_mesh(const SolidMesh& solid, const Square& s) {
    // Clipping may lose a sliver at the border of the square to rounding: use a slightly larger
    // one.
    const Square wide{s.x0 - rounding, s.x1 + rounding, s.y0 - rounding, s.y1 + rounding};
    const Mesh near = triangles_over(solid, wide);
    IntervalList heights;
    for (size_t i = 0; i < near.triangles.size(); ++i)
        heights.add(heights_within(near.triangle(i), wide));
    for (const double x : {s.x0, s.x1})
        for (const double y : {s.y0, s.y1})
            for (const Interval& interval : matter_on_line(near, 2, x, y)) heights.add(interval);
    return heights;
}

IntervalList line_of_mesh(const SolidMesh& solid, int axis, double u, double v) {
    // Refining squares queries lines along Z one by one.
    if (axis == 2) return matter_on_line(triangles_over(solid, {u, u, v, v}), 2, u, v);
    return matter_on_line(*solid.mesh, axis, u, v);
}

IntervalList nominal_column(const Solid& solid, const Square& s) {
    return std::visit(Overloaded{[&](const SolidBox& b) -> IntervalList {
                                     if (s.x1 < b.box.min.x || s.x0 > b.box.max.x
                                         || s.y1 < b.box.min.y || s.y0 > b.box.max.y)
                                         return {};
                                     return IntervalList({b.box.min.z, b.box.max.z});
                                 },
                                 [&](const SolidCylinder& c) { return column_of_cylinder(c, s); },
                                 [&](const SolidMesh& m) { return column_of_mesh(m, s); }},
                      solid.shape);
}

} // namespace

bool holds(const SolidMesh& solid, const Vec3& point) {
    if (!overlaps(bounds(solid), {point, point})) return false;
    const Mesh over = triangles_over(solid, {point.x, point.x, point.y, point.y});
    return matter_on_line(over, 2, point.x, point.y).contains(point.z);
}

Aabb bounds(const Solid& solid) {
    return std::visit(Overloaded{[](const SolidBox& b) { return b.box; },
                                 [](const SolidCylinder& c) { return bounds_of(c); },
                                 [](const SolidMesh& m) { return bounds(m); }},
                      solid.shape);
}

IntervalList line_of(const Solid& solid, int axis, double u, double v) {
    return std::visit(
        Overloaded{[&](const SolidBox& b) { return line_of_box(b.box, axis, u, v); },
                   [&](const SolidCylinder& c) { return line_of_cylinder(c, axis, u, v); },
                   [&](const SolidMesh& m) { return line_of_mesh(m, axis, u, v); }},
        solid.shape);
}

Aabb outer_bounds(const Solid& solid) {
    return displaced(bounds(solid), solid.play).grown(solid.tolerance);
}

IntervalList column_of(const Solid& solid, const Square& square) {
    const double t = solid.tolerance;
    if (t == 0.0 && solid.play.none()) return nominal_column(solid, square);
    const Vec3 least = solid.play.least() - Vec3(t), most = solid.play.most() + Vec3(t);
    IntervalList grown;
    const Square wide{square.x0 - most.x, square.x1 - least.x, square.y0 - most.y,
                      square.y1 - least.y};
    for (const Interval& interval : nominal_column(solid, wide))
        grown.add({interval.lower + least.z, interval.upper + most.z});
    return grown;
}

Result<Dbm> scan(const Solid& solid, double spacing, double memory_limit) {
    Aabb box = bounds(solid);
    box.extend(displaced(box, solid.play));
    if (const auto* m = std::get_if<SolidMesh>(&solid.shape))
        return scan(*m->mesh, box, spacing, memory_limit);
    return scan_lines_of(
        box, spacing, [&](int axis, double u, double v) { return line_of(solid, axis, u, v); },
        memory_limit);
}

} // namespace core

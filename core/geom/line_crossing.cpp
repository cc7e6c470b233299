#include "core/geom/line_crossing.h"

#include <algorithm>

namespace core {

ProjectedTriangle project(const Triangle& triangle, int axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    return {{Vec2(triangle.a[u], triangle.a[v]), Vec2(triangle.b[u], triangle.b[v]),
             Vec2(triangle.c[u], triangle.c[v])},
            {triangle.a[axis], triangle.b[axis], triangle.c[axis]}};
}

int edge_step(const Vec2& a, const Vec2& b, const Vec2& p) {
    // The shifted line lies above a corner at its own height: half-open spans.
    if ((a.y <= p.y) == (b.y <= p.y)) return 0;
    const bool upwards = a.y <= p.y;
    // Both triangles of an edge ask about the same upward edge. A line on it is shifted to +u, so
    // the edge passes on its -u side: zero counts as "not left of the edge".
    const double side = upwards ? orientation(a, b, p) : orientation(b, a, p);
    if (!(side > 0.0)) return 0;
    return upwards ? 1 : -1;
}

int crossing_step(const ProjectedTriangle& triangle, const Vec2& p) {
    const auto& [a, b, c] = triangle.corner;
    return edge_step(a, b, p) + edge_step(b, c, p) + edge_step(c, a, p);
}

double crossing_depth(const ProjectedTriangle& triangle, const Vec2& p) {
    const auto& [a, b, c] = triangle.corner;
    const auto& [at_a, at_b, at_c] = triangle.along;
    // The weights have one sign where the line meets the triangle, so nothing cancels in the sums.
    const double of_a = orientation(b, c, p);
    const double of_b = orientation(c, a, p);
    const double of_c = orientation(a, b, p);
    const double sum = of_a + of_b + of_c;
    const double depth = sum == 0.0 ? at_a : (of_a * at_a + of_b * at_b + of_c * at_c) / sum;
    return std::clamp(depth, std::min({at_a, at_b, at_c}), std::max({at_a, at_b, at_c}));
}

} // namespace core

#include "core/geom/line_crossing.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace core {

ProjectedTriangle project(const Triangle& triangle, int axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    return {{Vec2(triangle.a[u], triangle.a[v]), Vec2(triangle.b[u], triangle.b[v]),
             Vec2(triangle.c[u], triangle.c[v])},
            {triangle.a[axis], triangle.b[axis], triangle.c[axis]}};
}

int edge_step(const Vec2& a, const Vec2& b, const Vec2& p) {
    // The shifted line is above a corner at its own height: half-open spans.
    if ((a.y <= p.y) == (b.y <= p.y)) return 0;
    const bool upwards = a.y <= p.y;
    // Both triangles of an edge evaluate the same upward edge. A line on it is shifted to +u, so
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

namespace {

/// A number as the sum of two of at most 26 bits, so that products of such parts are exact; for
/// numbers below 1e290. Source: Dekker, "A floating-point technique for extending the available
/// precision" (1971).
std::array<double, 2> split(double x) {
    const double scaled = 134217729.0 * x; // 2^27 + 1
    const double high = scaled - (scaled - x);
    return {high, x - high};
}

/// A sum of doubles kept exactly: components that do not overlap, smallest first.
class ExactSum {
public:
    void add(double x) {
        size_t kept = 0;
        for (size_t i = 0; i < size_; ++i) {
            const double sum = x + parts_[i];
            const double of_part = sum - x;
            const double rest = (x - (sum - of_part)) + (parts_[i] - of_part);
            if (rest != 0.0) parts_[kept++] = rest;
            x = sum;
        }
        if (x != 0.0) parts_[kept++] = x;
        size_ = kept;
    }

    void add_product(double x, double y) {
        // std::fma is not exact in every C library.
        const double product = x * y;
        const auto [a, b] = split(x);
        const auto [c, d] = split(y);
        add(((a * c - product) + a * d + b * c) + b * d);
        add(product);
    }

    double value() const {
        double sum = 0.0;
        for (size_t i = 0; i < size_; ++i) sum += parts_[i];
        return sum;
    }

private:
    std::array<double, 16> parts_ = {};
    size_t size_ = 0;
};

double exact_orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
    // Multiplied out, so that no difference is rounded; c.x c.y cancels.
    ExactSum sum;
    sum.add_product(a.x, b.y);
    sum.add_product(-a.x, c.y);
    sum.add_product(-c.x, b.y);
    sum.add_product(-a.y, b.x);
    sum.add_product(a.y, c.x);
    sum.add_product(c.y, b.x);
    return sum.value();
}

} // namespace

double orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
    const double left = (a.x - c.x) * (b.y - c.y);
    const double right = (a.y - c.y) * (b.x - c.x);
    const double area = left - right;
    // The relative error of each product is at most 2.0e-16 * 3; requiring 0.004 leaves 1e-13 of
    // the difference.
    if (std::abs(area) > 0.004 * (std::abs(left) + std::abs(right))) return area;
    return exact_orientation(a, b, c);
}

} // namespace core

#include "core/geom/oriented_box.h"

#include <array>
#include <cmath>

namespace core {
namespace {

/// Covers rounding in the box, as a share of the coordinates: see README.md, "Boxes".
constexpr double rounding = 1e-14;

Aabb bounds_of(std::span<const Triangle> triangles) {
    Aabb box;
    for (const Triangle& t : triangles)
        for (const Vec3& p : {t.a, t.b, t.c}) box.extend(p);
    return box;
}

/// Second moments of the area about a point, but for a factor.
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

/// The eigenvectors of a symmetric matrix, by Jacobi's rotations.
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

/// Axes along the longest side and the normal of the triangle that has the longest side; anything
/// at all when it has no area.
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

/// Gram-Schmidt on the first two columns, twice: after the first pass what is left of a short
/// second column may still lean.
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
    double reach_a[3] = {a.half.x, a.half.y, a.half.z}; // of both along A's axes
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

} // namespace core

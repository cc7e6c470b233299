#include "core/distance/turned_box.h"

#include <algorithm>
#include <cmath>

namespace core {
namespace {

using Axes = std::array<Vec3, 3>;

struct Extent {
    std::array<double, 3> lower, upper;
};

Vec3 to_single(const Vec3& v) { return Vec3(glm::vec3(v)); }

Axes rounded(const Axes& axes) {
    return {to_single(axes[0]), to_single(axes[1]), to_single(axes[2])};
}

/// Eigenvectors of the points' scatter, largest first, by Jacobi's rotations.
Axes principal_axes(std::span<const Vec3> points) {
    Vec3 mean(0.0);
    for (const Vec3& p : points) mean += p - points[0];
    mean = points[0] + mean / static_cast<double>(points.size());
    std::array<std::array<double, 3>, 3> m{};
    for (const Vec3& p : points) {
        const Vec3 d = p - mean;
        m[0][0] += d.x * d.x, m[1][1] += d.y * d.y, m[2][2] += d.z * d.z;
        m[0][1] += d.x * d.y, m[1][2] += d.y * d.z, m[0][2] += d.z * d.x;
    }
    m[1][0] = m[0][1], m[2][1] = m[1][2], m[2][0] = m[0][2];
    Axes axes = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    for (int step = 0; step < 12; ++step) {
        const size_t p = step % 3 == 2 ? 1 : 0, q = step % 3 == 0 ? 1 : 2;
        if (std::abs(m[p][q]) <= 1e-14 * (m[0][0] + m[1][1] + m[2][2])) continue;
        const double theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
        const double t =
            (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
        const size_t r = 3 - p - q;
        const double mpp = m[p][p], mqq = m[q][q], mpq = m[p][q], mrp = m[r][p], mrq = m[r][q];
        m[p][p] = mpp - t * mpq, m[q][q] = mqq + t * mpq;
        m[p][q] = m[q][p] = 0.0;
        m[r][p] = m[p][r] = c * mrp - s * mrq;
        m[r][q] = m[q][r] = s * mrp + c * mrq;
        const Vec3 ap = axes[p], aq = axes[q];
        axes[p] = c * ap - s * aq;
        axes[q] = s * ap + c * aq;
    }
    std::array<size_t, 3> order = {0, 1, 2};
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return m[a][a] != m[b][b] ? m[a][a] > m[b][b] : a < b; });
    const Vec3 n = glm::normalize(axes[order[2]]);
    const Vec3 first = glm::normalize(axes[order[0]] - glm::dot(axes[order[0]], n) * n);
    return {first, glm::cross(n, first), n};
}

/// The axes turned about the last one so that the first lies as the frame does.
Axes squared_up(const Axes& axes) {
    const Vec3 n = axes[2];
    const Vec3 a = glm::abs(n);
    const int least = a.x <= a.y && a.x <= a.z ? 0 : a.y <= a.z ? 1 : 2;
    Vec3 along(0.0);
    along[least] = 1.0;
    const Vec3 first = glm::normalize(along - glm::dot(along, n) * n);
    return {first, glm::cross(n, first), n};
}

Extent extent_of(std::span<const Vec3> points, const Vec3& origin, const Axes& axes) {
    Extent e{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (const Vec3& p : points) {
        const Vec3 d = p - origin;
        for (size_t k = 0; k < 3; ++k) {
            const double x = glm::dot(axes[k], d);
            e.lower[k] = std::min(e.lower[k], x);
            e.upper[k] = std::max(e.upper[k], x);
        }
    }
    return e;
}

double surface(const Extent& e) {
    const double a = e.upper[0] - e.lower[0], b = e.upper[1] - e.lower[1],
                 c = e.upper[2] - e.lower[2];
    return a * b + b * c + c * a;
}

TurnedBox box_of(const Extent& e, const Axes& axes) {
    Vec3 centre(0.0);
    for (size_t k = 0; k < 3; ++k) centre += 0.5 * (e.lower[k] + e.upper[k]) * axes[k];
    centre = to_single(centre);
    TurnedBox box;
    std::array<double, 3> half{};
    for (size_t k = 0; k < 3; ++k) {
        const double at = glm::dot(axes[k], centre);
        half[k] = std::max({e.upper[k] - at, at - e.lower[k], 0.0});
    }
    const double radius = std::sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
    for (size_t k = 0; k < 3; ++k) {
        // Rounded axes are orthonormal to 4e-7, so a projection is off by that share of the radius;
        // so much more on each axis covers it, as |u . axis| add up to at least 1.
        box.half[k] = rounded_up(half[k] + 1e-6 * radius);
        box.centre[k] = static_cast<float>(centre[static_cast<int>(k)]);
        for (int j = 0; j < 3; ++j)
            box.axis[k][static_cast<size_t>(j)] = static_cast<float>(axes[k][j]);
    }
    box.radius = rounded_up(radius * (1.0 + 1e-6));
    return box;
}

} // namespace

TurnedBox turned_box(const Aabb& box, const Vec3& origin) {
    const Vec3 lower = box.min - origin, upper = box.max - origin;
    return box_of({{lower.x, lower.y, lower.z}, {upper.x, upper.y, upper.z}},
                  {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)});
}

TurnedBox turned_box(std::span<const Vec3> points, const Vec3& origin) {
    const Axes principal = principal_axes(points);
    Axes best = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    Extent extent = extent_of(points, origin, best);
    for (const Axes& candidate : {rounded(principal), rounded(squared_up(principal))}) {
        const Extent other = extent_of(points, origin, candidate);
        if (surface(other) < surface(extent)) {
            extent = other;
            best = candidate;
        }
    }
    return box_of(extent, best);
}

} // namespace core

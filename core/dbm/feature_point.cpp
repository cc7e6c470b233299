#include "core/dbm/feature_point.h"

#include <algorithm>
#include <array>

namespace core {
namespace {

/// Directions in which the planes say less than this share of what they say at most are left alone:
/// edges flatter than some 16 degrees are taken for curvature.
constexpr double weakest = 0.02;

using Matrix = std::array<std::array<double, 3>, 3>;

/// Turns the matrix so that the entry (p, q) vanishes, and the frame with it.
void rotate(Matrix& a, Matrix& frame, size_t p, size_t q) {
    if (a[p][q] == 0.0) return;
    const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    const double t =
        (theta < 0.0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
    const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
    for (size_t k = 0; k < 3; ++k) {
        const double kp = a[k][p], kq = a[k][q];
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
    }
    for (size_t k = 0; k < 3; ++k) {
        const double pk = a[p][k], qk = a[q][k];
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
        const double fp = frame[k][p], fq = frame[k][q];
        frame[k][p] = c * fp - s * fq;
        frame[k][q] = s * fp + c * fq;
    }
}

} // namespace

Vec3 feature_point(std::span<const TangentPlane> points, const Aabb& room) {
    Vec3 middle(0.0);
    for (const TangentPlane& point : points) middle += point.place;
    middle /= static_cast<double>(points.size());
    const bool flat = std::all_of(points.begin(), points.end(), [&](const TangentPlane& point) {
        return point.normal == points.front().normal;
    });
    if (flat) return glm::clamp(middle, room.min, room.max); // it is in their mean plane
    Matrix a{}, frame{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    Vec3 right(0.0);
    for (const TangentPlane& point : points) {
        const Vec3& n = point.normal;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                a[static_cast<size_t>(i)][static_cast<size_t>(j)] += n[i] * n[j];
        right += glm::dot(n, point.place - middle) * n;
    }
    for (int sweep = 0; sweep < 12; ++sweep)
        for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}})
            rotate(a, frame, static_cast<size_t>(p), static_cast<size_t>(q));
    const double strongest = std::max({a[0][0], a[1][1], a[2][2]});
    Vec3 by(0.0);
    for (size_t k = 0; k < 3; ++k) {
        if (!(a[k][k] > weakest * strongest)) continue;
        const Vec3 direction(frame[0][k], frame[1][k], frame[2][k]);
        by += glm::dot(direction, right) / a[k][k] * direction;
    }
    return glm::clamp(middle + by, room.min, room.max);
}

} // namespace core

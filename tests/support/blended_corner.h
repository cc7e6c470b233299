#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/vec.h"

namespace test_support {

/// A corner between two straight moves, from `a` over `corner` to `b`.
struct StraightCorner {
    core::Vec3 a, corner, b;
};

/// Positions of a machine that brakes on the first move while it accelerates on the second, both at
/// constant acceleration, simulated in time. It starts within half of the first move and ends
/// within half of the second, with the greatest speed at which it comes no nearer to the corner
/// than `tolerance` allows.
inline std::vector<core::Vec3> blended(const StraightCorner& path, double acceleration,
                                       double fastest, double tolerance, int steps = 400) {
    const core::Vec3 in = glm::normalize(path.corner - path.a);
    const core::Vec3 out = glm::normalize(path.b - path.corner);
    const double shorter =
        std::min(glm::distance(path.a, path.corner), glm::distance(path.corner, path.b));
    const auto positions = [&](double speed) {
        std::vector<core::Vec3> at;
        const double time = speed / acceleration;
        for (int i = 0; i <= steps; ++i) {
            const double t = time * i / steps;
            const double to_go = 0.5 * acceleration * (time - t) * (time - t);
            at.push_back(path.corner - to_go * in + 0.5 * acceleration * t * t * out);
        }
        return at;
    };
    // Half way, it is nearest to the corner.
    const auto miss = [&](double speed) {
        return glm::distance(positions(speed)[static_cast<size_t>(steps) / 2], path.corner);
    };
    double low = 0.0, high = std::min(fastest, std::sqrt(acceleration * shorter));
    if (miss(high) <= tolerance) return positions(high);
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (miss(middle) <= tolerance ? low : high) = middle;
    }
    return positions(low);
}

/// Positions on the circle that touches both moves at the distance `from_corner` from the corner.
inline std::vector<core::Vec3> on_a_circle(const StraightCorner& path, double from_corner,
                                           int steps = 400) {
    const core::Vec3 back = glm::normalize(path.a - path.corner);
    const core::Vec3 out = glm::normalize(path.b - path.corner);
    const double half = 0.5 * std::acos(std::clamp(glm::dot(back, out), -1.0, 1.0));
    const core::Vec3 middle = glm::normalize(back + out);
    const core::Vec3 centre = path.corner + from_corner / std::cos(half) * middle;
    const double radius = from_corner * std::tan(half);
    const core::Vec3 side = glm::normalize(out - back);
    const double sweep = 0.5 * std::acos(-1.0) - half;
    std::vector<core::Vec3> at;
    for (int i = 0; i <= steps; ++i) {
        const double angle = sweep * (2.0 * i / steps - 1.0);
        at.push_back(centre - radius * (std::cos(angle) * middle - std::sin(angle) * side));
    }
    return at;
}

} // namespace test_support

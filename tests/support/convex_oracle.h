#pragma once

#include <random>

#include "core/geom/gjk.h"

namespace test_support {

/// The extent of a shape along a unit direction, directly from its definition.
inline double reach(const core::ConvexShape& shape, const core::Vec3& n) {
    double core_reach = -core::infinity;
    if (shape.core == core::ConvexShape::Core::cone) {
        const core::Vec3 local = glm::transpose(shape.orientation) * n;
        const double across = std::hypot(local.x, local.y);
        core_reach = std::max(shape.cone.r0 * across + shape.cone.z0 * local.z,
                              shape.cone.r1 * across + shape.cone.z1 * local.z);
    }
    for (size_t i = 0; i < shape.point_count; ++i)
        core_reach = std::max(core_reach, glm::dot(shape.points[i], n));
    double place_reach = -core::infinity;
    for (size_t i = 0; i < shape.position_count; ++i)
        place_reach = std::max(place_reach, glm::dot(shape.positions[i].at, n));
    return core_reach + place_reach + shape.margin;
}

inline core::Vec3 random_direction(std::mt19937& rng) {
    std::normal_distribution<double> part;
    for (;;) {
        const core::Vec3 v(part(rng), part(rng), part(rng));
        if (glm::length(v) > 1e-3) return glm::normalize(v);
    }
}

/// The greatest value of `gap(n)` over unit directions found by a short pattern search from
/// `start`.
template <typename Gap>
double greatest_gap(const Gap& gap, core::Vec3 start, double first_step = 0.5) {
    double best = gap(start);
    double step = first_step;
    for (int i = 0; i < 60 && step > 1e-9; ++i) {
        const core::Vec3 side = std::abs(start.x) < 0.7 ? core::Vec3(1, 0, 0) : core::Vec3(0, 1, 0);
        const core::Vec3 e = glm::normalize(glm::cross(start, side)), f = glm::cross(start, e);
        bool better = false;
        for (const core::Vec3& by : {e, -e, f, -f, e + f, e - f, f - e, -e - f}) {
            const core::Vec3 n = glm::normalize(start + step * by);
            const double here = gap(n);
            if (!(here > best)) continue;
            best = here;
            start = n;
            better = true;
            break;
        }
        if (!better) step *= 0.5;
    }
    return best;
}

/// The width of the widest slab found between A and B. Every slab is a lower bound of their
/// distance; the widest of all is the distance.
inline double slab_between(const core::ConvexShape& a, const core::ConvexShape& b,
                           const core::Vec3& from_b_to_a, std::mt19937& rng) {
    const auto gap = [&](const core::Vec3& n) { return -reach(a, -n) - reach(b, n); };
    double best = -core::infinity;
    if (glm::length(from_b_to_a) > 0.0) best = greatest_gap(gap, glm::normalize(from_b_to_a), 1e-4);
    core::Vec3 start = random_direction(rng);
    for (int i = 0; i < 20; ++i) {
        const core::Vec3 n = random_direction(rng);
        if (gap(n) > gap(start)) start = n;
    }
    return std::max(best, greatest_gap(gap, start));
}

/// A lower bound of the distance of a point outside a shape; at most 0 if no direction separates
/// them.
inline double certainly_outside(const core::ConvexShape& shape, const core::Vec3& p,
                                std::mt19937& rng) {
    const auto gap = [&](const core::Vec3& n) { return glm::dot(n, p) - reach(shape, n); };
    core::Vec3 start(0, 0, 1);
    for (int i = 0; i < 40; ++i) {
        const core::Vec3 n = random_direction(rng);
        if (gap(n) > gap(start)) start = n;
    }
    return greatest_gap(gap, start);
}

} // namespace test_support

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geom/profile.h"

namespace test_support {

/// The distance of a point outside a piece: convex in the point and at most the true distance.
/// Inside it is exactly minus the distance to the surface.
inline double outside(const core::ProfileElement& e, const core::Vec3& p) {
    const double r = std::hypot(p.x, p.y);
    if (e.margin > 0.0) {
        const double beyond = std::max(0.0, r - e.r0);
        return std::hypot(beyond, p.z - e.z0) - e.margin;
    }
    const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    const double side = (r - e.r0 - slope * (p.z - e.z0)) / std::sqrt(1.0 + slope * slope);
    return std::max({e.z0 - p.z, p.z - e.z1, side});
}

inline double outside(const core::RevolvedProfile& profile, const core::Vec3& p) {
    double least = core::infinity;
    for (const core::ProfileElement& e : profile.elements) least = std::min(least, outside(e, p));
    return least;
}

/// The argument between `low` and `high` at which a convex function is least, by golden section.
template <typename Function>
double argmin_convex(const Function& f, double low, double high, int steps = 70) {
    constexpr double golden = 0.6180339887498949;
    double a = high - golden * (high - low), b = low + golden * (high - low);
    double fa = f(a), fb = f(b);
    for (int i = 0; i < steps; ++i) {
        if (fa > fb) {
            low = a;
            a = b;
            fa = fb;
            fb = f(b = low + golden * (high - low));
        } else {
            high = b;
            b = a;
            fb = fa;
            fa = f(a = high - golden * (high - low));
        }
    }
    return fa < fb ? a : b;
}

/// As `outside`, for a piece moved straight between two positions.
inline double outside_sweep(const core::ProfileElement& e, const core::Vec3& from,
                            const core::Vec3& to, const core::Vec3& p) {
    const auto at = [&](double t) { return outside(e, p - (from + t * (to - from))); };
    return std::min({at(0.0), at(1.0), at(argmin_convex(at, 0.0, 1.0))});
}

inline double outside_sweep(const core::RevolvedProfile& profile, const core::Vec3& from,
                            const core::Vec3& to, const core::Vec3& p) {
    double least = core::infinity;
    for (const core::ProfileElement& e : profile.elements)
        least = std::min(least, outside_sweep(e, from, to, p));
    return least;
}

/// Points (r, z) along the outline of the union of the pieces, at most `step` apart. Seams inside
/// the body are not part of the outline.
inline std::vector<core::Vec3> outline(const core::RevolvedProfile& profile, double step) {
    std::vector<core::Vec3> points;
    const auto offer = [&](const core::Vec3& p) {
        for (int k = 0; k < 16; ++k) {
            const core::Vec3 by(std::cos(0.1 + k * 0.3927), 0.0, std::sin(0.1 + k * 0.3927));
            if (p.x + 1e-7 * by.x < 0.0 || outside(profile, p + 1e-7 * by) <= 1e-9) continue;
            if (outside(profile, p) > -1e-9) points.push_back(p);
            return;
        }
    };
    const auto line = [&](const core::Vec3& a, const core::Vec3& b) {
        const int n = 1 + static_cast<int>(glm::distance(a, b) / step);
        for (int i = 0; i <= n; ++i) offer(a + (b - a) * (double(i) / n));
    };
    for (const core::ProfileElement& e : profile.elements) {
        if (e.margin > 0.0) {
            const int n = 1 + static_cast<int>(3.2 * e.margin / step);
            for (int i = 0; i <= n; ++i) {
                const double angle = 3.14159265358979 * (double(i) / n - 0.5);
                offer({e.r0 + e.margin * std::cos(angle), 0.0, e.z0 + e.margin * std::sin(angle)});
            }
            line({0, 0, e.z0 - e.margin}, {e.r0, 0, e.z0 - e.margin});
            line({0, 0, e.z0 + e.margin}, {e.r0, 0, e.z0 + e.margin});
            continue;
        }
        line({0, 0, e.z0}, {e.r0, 0, e.z0});
        line({e.r0, 0, e.z0}, {e.r1, 0, e.z1});
        line({e.r1, 0, e.z1}, {0, 0, e.z1});
    }
    return points;
}

} // namespace test_support

#pragma once

#include <algorithm>
#include <cmath>

#include "core/geom/profile.h"

namespace test_support {

/// A point relative to a convex piece: its distance outside, or minus its depth inside, and the
/// nearest point of the piece (inside, the point itself). Plane geometry in the half-plane of the
/// axis.
struct PieceDistance {
    double distance;
    core::Vec3 nearest;
};

struct HalfPlanePoint {
    double r = 0.0, z = 0.0;
};

inline double distance(const HalfPlanePoint& a, const HalfPlanePoint& b) {
    return std::sqrt((a.r - b.r) * (a.r - b.r) + (a.z - b.z) * (a.z - b.z));
}

inline HalfPlanePoint nearest_on_segment(const HalfPlanePoint& p, const HalfPlanePoint& a,
                                         const HalfPlanePoint& b) {
    const double r = b.r - a.r, z = b.z - a.z, square = r * r + z * z;
    if (square == 0.0) return a;
    const double t = std::clamp(((p.r - a.r) * r + (p.z - a.z) * z) / square, 0.0, 1.0);
    return {a.r + t * r, a.z + t * z};
}

/// The distance in the half-plane from the piece without its margin.
inline double core_distance(const core::ProfileElement& e, const HalfPlanePoint& p,
                            HalfPlanePoint& nearest) {
    const HalfPlanePoint corners[4] = {{0.0, e.z0}, {e.r0, e.z0}, {e.r1, e.z1}, {0.0, e.z1}};
    double least = core::infinity;
    for (int i = 0; i < 3; ++i) {
        const HalfPlanePoint here = nearest_on_segment(p, corners[i], corners[i + 1]);
        const double apart = distance(p, here);
        if (apart >= least) continue;
        least = apart;
        nearest = here;
    }
    const double side = (e.r1 - e.r0) * (p.z - e.z0) - (e.z1 - e.z0) * (p.r - e.r0);
    return p.z > e.z0 && p.z < e.z1 && side > 0.0 ? -least : least;
}

/// The distance of a point from a piece; negative inside. Convex in the point.
inline double true_distance(const core::ProfileElement& e, const core::Vec3& p) {
    HalfPlanePoint nearest;
    return core_distance(e, {std::sqrt(p.x * p.x + p.y * p.y), p.z}, nearest) - e.margin;
}

/// The distance outside a profile; inside, negative by at most the true depth.
inline double true_distance(const core::RevolvedProfile& profile, const core::Vec3& p) {
    double least = core::infinity;
    for (const core::ProfileElement& e : profile.elements)
        least = std::min(least, true_distance(e, p));
    return least;
}

inline PieceDistance nearest_of(const core::ProfileElement& e, const core::Vec3& p) {
    const double r = std::sqrt(p.x * p.x + p.y * p.y);
    HalfPlanePoint nearest;
    const double core = core_distance(e, {r, p.z}, nearest), apart = core - e.margin;
    if (apart <= 0.0) return {apart, p};
    const double fraction = e.margin / core;
    const double to_r = nearest.r + fraction * (r - nearest.r);
    const double to_z = nearest.z + fraction * (p.z - nearest.z);
    const double scale = r > 0.0 ? to_r / r : 0.0;
    const core::Vec3 on =
        r > 0.0 ? core::Vec3(p.x * scale, p.y * scale, to_z) : core::Vec3(to_r, 0.0, to_z);
    return {apart, on};
}

inline PieceDistance nearest_of(const core::RevolvedProfile& profile, const core::Vec3& p) {
    PieceDistance best{core::infinity, p};
    for (const core::ProfileElement& e : profile.elements) {
        const PieceDistance here = nearest_of(e, p);
        if (here.distance < best.distance) best = here;
    }
    return best;
}

/// A profile and its enclosing cylinder.
struct TrueProfile {
    core::RevolvedProfile profile;
    core::ProfileElement hull;

    explicit TrueProfile(core::RevolvedProfile of) : profile(std::move(of)) {
        const core::Aabb box = core::bounds(profile);
        hull = {box.min.z, box.max.x, box.max.z, box.max.x, 0.0};
    }
};

} // namespace test_support

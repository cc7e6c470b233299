#include "core/dbm/sweep_front.h"

namespace core {
namespace {

/// Added to where the front begins, mm: above what rounding may move it by.
constexpr double margin = 1e-6;

/// How far behind the axis, seen along the move from above, the surface of an element still faces
/// the motion `by`; its end faces only where they are not covered.
double reach_back(const ProfileElement& e, const Vec3& by, bool bottom_open, bool top_open) {
    if (by.z == 0.0) return 0.0;
    const double widest = std::max(e.r0, e.r1);
    if (e.margin > 0.0) return widest + e.margin * std::abs(by.z) / glm::length(by);
    double back = 0.0;
    if (e.z1 > e.z0) {
        // The flank's normal is (cos, sin, -slope): it faces the motion where its cosine is at
        // least slope * by.z / length.
        const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
        back = widest * std::clamp(-slope * by.z / std::hypot(by.x, by.y), 0.0, 1.0);
    }
    if (by.z < 0.0 && bottom_open) back = std::max(back, e.r0);
    if (by.z > 0.0 && top_open) back = std::max(back, e.r1);
    return back;
}

/// The part of a disc from which a cutter's front reaches forwards.
struct FrontDisc {
    double radius = 0.0, back = 0.0;
};

FrontDisc front_disc(const CutterSweep& sweep, double top) {
    const double lowest = std::min(sweep.from.z, sweep.to.z);
    FrontDisc disc;
    for (const Cutter::Piece& piece : sweep.cutter->pieces) {
        // Within a convex piece the elements cover each other's faces.
        const auto& all = piece.around.elements;
        for (size_t i = 0; i < all.size(); ++i) {
            const bool top_open = i + 1 == all.size() && lowest + all[i].z1 < top;
            const double back = reach_back(all[i], sweep.to - sweep.from, i == 0, top_open);
            disc.back = std::max(disc.back, back);
            disc.radius = std::max(disc.radius, bounds(all[i]).max.x);
        }
    }
    disc.back = std::min(disc.back + margin, disc.radius);
    return disc;
}

/// How far the part of the disc that lies at least -back along a path reaches in a direction, given
/// by its components along the path and across it.
double reach(const FrontDisc& disc, double along, double across) {
    if (along * disc.radius >= -disc.back) return disc.radius;
    const double chord = std::sqrt((disc.radius - disc.back) * (disc.radius + disc.back));
    return -disc.back * along + chord * std::abs(across);
}

} // namespace

Aabb front_bounds(const CutterSweep& sweep, double top) {
    Aabb front = bounds(sweep);
    const Vec3 by = sweep.to - sweep.from;
    const double length = std::hypot(by.x, by.y);
    if (!is_upright(sweep.orientation) || sweep.cutter->path_error > 0.0 || length <= margin)
        return front;
    const FrontDisc disc = front_disc(sweep, top);
    const double x = by.x / length, y = by.y / length;
    front.max.x = std::max(sweep.from.x, sweep.to.x) + reach(disc, x, y);
    front.min.x = std::min(sweep.from.x, sweep.to.x) - reach(disc, -x, y);
    front.max.y = std::max(sweep.from.y, sweep.to.y) + reach(disc, y, x);
    front.min.y = std::min(sweep.from.y, sweep.to.y) - reach(disc, -y, x);
    return front;
}

} // namespace core

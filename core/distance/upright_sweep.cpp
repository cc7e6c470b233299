#include "core/distance/upright_sweep.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"

namespace core {
namespace {

/// A point of the half plane through the axis: distance from the axis, and height.
struct Point2 {
    double r = 0.0, z = 0.0;
};

/// Two points of the half plane, on the piece and on the box.
struct Pair2 {
    Point2 piece, box;
    double square = infinity; // of their distance
};

Pair2 between(const Point2& piece, const Point2& box) {
    const double r = box.r - piece.r, z = box.z - piece.z;
    return {piece, box, r * r + z * z};
}

Point2 nearest_on(const Point2& a, const Point2& b, const Point2& p) {
    const double r = b.r - a.r, z = b.z - a.z;
    const double length = r * r + z * z;
    const double along = (p.r - a.r) * r + (p.z - a.z) * z;
    const double t = length > 0.0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
    return {a.r + t * r, a.z + t * z};
}

/// The piece at a height above its origin, and a box in the half plane: all points at least `apart`
/// from the axis, from `bottom` up to `top`.
struct HalfPlane {
    Point2 low, high; // the rims of the piece
    double apart = 0.0, bottom = 0.0, top = 0.0;
};

/// Wall against wall, face against face, or rim against edge.
Pair2 nearest_to_cylinder(const HalfPlane& h) {
    Pair2 near;
    near.box.r = h.apart;
    near.piece.r = std::min(h.apart, h.low.r);
    if (h.top < h.low.z) {
        near.box.z = h.top, near.piece.z = h.low.z;
    } else if (h.bottom > h.high.z) {
        near.box.z = h.bottom, near.piece.z = h.high.z;
    } else {
        near.box.z = near.piece.z = std::max(h.bottom, h.low.z);
    }
    return between(near.piece, near.box);
}

Pair2 nearest_to_cone(const HalfPlane& h) {
    if (h.top < h.low.z && h.apart <= h.low.r) return between({h.apart, h.low.z}, {h.apart, h.top});
    if (h.bottom > h.high.z && h.apart <= h.high.r)
        return between({h.apart, h.high.z}, {h.apart, h.bottom});
    const double from = std::max(h.bottom, h.low.z), to = std::min(h.top, h.high.z);
    if (from <= to) {
        const double height = h.high.z - h.low.z;
        const double z = h.high.r > h.low.r ? to : from;
        const double r = height > 0.0 ? h.low.r + (h.high.r - h.low.r) / height * (z - h.low.z)
                                      : std::max(h.low.r, h.high.r);
        if (h.apart <= r) return between({h.apart, z}, {h.apart, z});
    }
    // Two walls that do not cross: an end of one of them is nearest.
    const auto on_wall = [&](const Point2& rim) {
        return Point2{h.apart, std::clamp(rim.z, h.bottom, h.top)};
    };
    Pair2 best = between(h.low, on_wall(h.low));
    for (const Pair2& other :
         {between(h.high, on_wall(h.high)),
          between(nearest_on(h.low, h.high, {h.apart, h.bottom}), {h.apart, h.bottom}),
          between(nearest_on(h.low, h.high, {h.apart, h.top}), {h.apart, h.top})})
        if (other.square < best.square) best = other;
    return best;
}

/// The distance at one time, and its slope: the distance is a convex function of time and lies
/// above this tangent everywhere.
struct Moment {
    double time = 0.0;
    double distance = 0.0; // of the piece without its margin
    double slope = 0.0;
    Pair2 near;
    double x = 0.0, y = 0.0; // of the point of the box nearest to the axis, seen from above
};

class SweepSearch {
public:
    SweepSearch(const UprightSweep& sweep, const Aabb& box) : sweep_(sweep), box_(box) {}

    Moment at(double time) const {
        const ProfileElement& element = sweep_.element;
        const Vec3 here = sweep_.from + time * sweep_.by;
        Moment m{.time = time};
        m.x = std::clamp(here.x, box_.min.x, box_.max.x);
        m.y = std::clamp(here.y, box_.min.y, box_.max.y);
        const double dx = m.x - here.x, dy = m.y - here.y;
        const double apart = std::sqrt(dx * dx + dy * dy);
        const HalfPlane h{{element.r0, here.z + element.z0},
                          {element.r1, here.z + element.z1},
                          apart,
                          box_.min.z,
                          box_.max.z};
        m.near = element.r0 == element.r1 ? nearest_to_cylinder(h) : nearest_to_cone(h);
        if (m.near.square <= 0.0) return m;
        m.distance = std::sqrt(m.near.square);
        const double outward = (m.near.box.r - m.near.piece.r) / m.distance;
        const double upward = (m.near.box.z - m.near.piece.z) / m.distance;
        m.slope = -upward * sweep_.by.z;
        if (apart > 0.0) m.slope -= outward * (dx * sweep_.by.x + dy * sweep_.by.y) / apart;
        return m;
    }

    Separation witness(const Moment& m) const {
        const double margin = sweep_.element.margin;
        Separation found{.upper = std::max(0.0, m.distance - margin), .time_a = m.time};
        found.point_b = {m.x, m.y, m.near.box.z};
        if (found.upper == 0.0) {
            found.point_a = found.point_b;
            return found;
        }
        const Vec3 here = sweep_.from + m.time * sweep_.by;
        const double fraction = m.near.box.r > 0.0 ? m.near.piece.r / m.near.box.r : 0.0;
        found.point_a = {here.x + fraction * (m.x - here.x), here.y + fraction * (m.y - here.y),
                         m.near.piece.z};
        found.point_a += (margin / m.distance) * (found.point_b - found.point_a);
        return found;
    }

    /// The time of least distance, and a lower bound of the distance over all times.
    std::pair<Moment, double> nearest(const SeparationGoal& goal) const {
        const double limit = goal.limit + sweep_.element.margin;
        Moment before = at(0.0);
        double lower = before.distance + std::min(0.0, before.slope);
        if (before.slope >= 0.0 || lower >= limit) return {before, std::max(0.0, lower)};
        Moment after = at(1.0);
        if (after.slope <= 0.0) return {after, after.distance};
        // Between two times, the intersection of the tangents is a lower bound.
        constexpr int max_iterations = 64;
        for (int i = 0; i < max_iterations; ++i) {
            const Moment& best = before.distance <= after.distance ? before : after;
            const double gap = after.time - before.time;
            const double rise = after.slope - before.slope;
            const double step =
                std::clamp((before.distance - after.distance + after.slope * gap) / rise, 0.0, gap);
            lower = std::max(0.0, before.distance + before.slope * step);
            if (lower >= limit || best.distance - lower <= goal.tolerance)
                return {best, std::min(lower, best.distance)};
            const Moment middle = at(before.time + step);
            if (middle.slope == 0.0 || middle.distance <= lower) return {middle, middle.distance};
            (middle.slope < 0.0 ? before : after) = middle;
        }
        return {before.distance <= after.distance ? before : after, lower};
    }

private:
    const UprightSweep& sweep_;
    const Aabb& box_;
};

} // namespace

Separation separation(const UprightSweep& sweep, const Aabb& box, const SeparationGoal& goal) {
    const SweepSearch search(sweep, box);
    const auto [moment, lower] = search.nearest(goal);
    Separation found = search.witness(moment);
    found.lower = std::max(0.0, lower - sweep.element.margin);
    return found;
}

double distance_bound(const UprightSweep& sweep, const Aabb& box, double limit) {
    const double lower = SweepSearch(sweep, box).nearest({.limit = limit}).second;
    return std::max(0.0, lower - sweep.element.margin);
}

} // namespace core

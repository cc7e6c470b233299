// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_SLOPE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_SLOPE_H
#undef FEELER_LANE_SLOPE_H
#else
#define FEELER_LANE_SLOPE_H
#endif

#include "core/dbm/lane_circle.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

/// An end of an element's stretch on lines along Z, at a distance from its axis, and how it faces.
struct EndAt {
    Row at, facing;
};

HWY_INLINE EndAt lower_end(const ProfileElement& e, const Row& away) {
    if (e.margin > 0.0) {
        const Row beyond = most(away - std::max(e.r0, e.r1), row_of(0.0));
        const Row half = root((row_of(e.margin) - beyond) * (beyond + e.margin));
        return {row_of(e.z0) - half, half * half * (1.0 / (e.margin * e.margin))};
    }
    if (e.r1 < e.r0) return {row_of(e.z0), row_of(1.0)};
    const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    const Row slant = (away - e.r0) * (1.0 / slope) + e.z0;
    const Row leans = row_of(slope * slope / (1.0 + slope * slope));
    return {least(most(slant, row_of(e.z0)), row_of(e.z1)),
            choose(at_most(row_of(e.z0), slant), leans, row_of(1.0))};
}

/// The element upside down: its upper end is then a lower one, of the other sign.
ProfileElement turned_over(const ProfileElement& e) { return {-e.z1, e.r1, -e.z0, e.r0, e.margin}; }

/// How far ahead of the axis a rounded disc that climbs or sinks touches what it leaves, on lines
/// `aside` of its path: there the normal is square to the motion.
///
/// Source: with the sine of the normal's angle from the axis, the circle has the radius
///         d = r + m sine, and aside^2 = d^2 (1 + k^2 - k^2 / sine^2), k the move's slope. Newton's
///         steps; an error in the place is one of second order in height.
HWY_INLINE Row ahead_of_round(const ProfileElement& e, const Row& aside, double slope) {
    constexpr int rounds = 5;
    const double radius = std::max(e.r0, e.r1), whole = radius + e.margin;
    const double k2 = slope * slope;
    const Row square = aside * aside;
    const Row room = most(row_of(1.0 + k2) - square * (1.0 / (whole * whole)), row_of(k2));
    const Row across = (most(aside, row_of(0.0) - aside) - radius) * (1.0 / e.margin);
    const Row smallest = least(most(across, root(row_of(k2) / room)), row_of(1.0));
    Row sine = smallest;
    for (int i = 0; i < rounds; ++i) {
        const Row per = row_of(1.0) / sine;
        const Row steep = per * per * k2;
        const Row left = row_of(1.0 + k2) - steep;
        const Row d = sine * e.margin + radius;
        const Row change = d * (left * e.margin + d * steep * per) * 2.0;
        sine = least(most(sine - (d * d * left - square) / change, smallest), row_of(1.0));
    }
    const Row d = sine * e.margin + radius;
    return root(d * d - square);
}

/// The same for the lower end of a cone. Where it is flat, the foremost point of its face; where
/// the move is steeper than its flank, that of its rim.
HWY_INLINE Row ahead_of_cone(const ProfileElement& e, const Row& aside, double slope) {
    const double cosine = std::abs(slope) * (e.r1 - e.r0) / (e.z1 - e.z0);
    if (e.r1 < e.r0 || cosine >= 1.0) return row_of(infinity);
    const Row flank =
        most(aside, row_of(0.0) - aside) * (cosine / std::sqrt(1.0 - cosine * cosine));
    return most(flank, root((row_of(e.r0) - aside) * (aside + e.r0)));
}

/// The lower end of what a cone or a rounded disc sweeps while it climbs or sinks, on lines along
/// Z.
struct LowerEnds {
    EndAt end;
    RowMask met;
};

HWY_INLINE LowerEnds lower_ends(const CapsuleLanes& c, const ProfileElement& e, double from_z,
                                double by_z, const Row& u, double v) {
    const Row ou = u - c.from_u;
    const double ov = v - c.from_v;
    const Row g = ou * c.cos_u + row_of(ov * c.cos_v);
    const Row aside = ou * c.cos_v - row_of(ov * c.cos_u);
    const Row beyond = (row_of(c.radius) - aside) * (aside + c.radius);
    const Row rim = root(beyond);
    // How far the line is ahead of the axis while the element meets it.
    const Row first = most(row_of(0.0) - rim, g - c.length), last = least(rim, g);
    LowerEnds found;
    found.met = at_most(first, last) & at_most(row_of(0.0), beyond);
    if (!any(found.met)) return found;
    const double slope = by_z * c.per_length;
    const Row touch =
        e.margin > 0.0 ? ahead_of_round(e, aside, slope) : ahead_of_cone(e, aside, slope);
    // Lower ends are a convex function of the moment: what lies beyond the move's ends, they serve.
    const Row x = least(most(slope > 0.0 ? touch : row_of(0.0) - touch, first), last);
    found.end = lower_end(e, root(aside * aside + x * x));
    found.end.at = found.end.at + within_move((g - x) * c.per_length) * by_z + from_z;
    return found;
}

HWY_INLINE void add_slope_along(const ElementLanes& sloped, const Row& u, double v, Swept& all) {
    const CapsuleLanes& c = sloped.path;
    const LowerEnds low = lower_ends(c, sloped.element, c.from_a, c.by_a, u, v);
    if (!any(low.met)) return;
    unite_low(all, low.met, low.end.at, low.end.facing);
    const LowerEnds high = lower_ends(c, turned_over(sloped.element), -c.from_a, -c.by_a, u, v);
    unite_high(all, high.met, row_of(0.0) - high.end.at, high.end.facing);
}

/// Narrows the moments to those at which at + t * by is not negative.
HWY_INLINE void keep_where_positive(const Row& at, double by, Moments& moments) {
    constexpr double least_change = 1e-12; // less is none, and off by no more
    if (std::abs(by) <= least_change)
        moments.met = moments.met & at_most(row_of(0.0), at);
    else if (by > 0.0)
        moments.first = most(moments.first, at * (-1.0 / by));
    else
        moments.last = least(moments.last, at * (-1.0 / by));
}

/// A circle that moves and grows evenly, met by lines across it.
struct GrowingCircles {
    const AcrossLanes& c;
    Row radius, s; // at the start
    double by_radius, flatness;

    /// Offers what lines meet at these moments.
    HWY_INLINE void offer(const Row& at, const Moments& within, Swept& all) const {
        const Row t = least(most(at, within.first), within.last);
        const Row r = radius + t * by_radius, aside = s - t * c.by_side;
        const Row half = root((r - aside) * (r + aside));
        const Row facing = half * half * flatness / most(r * r, row_of(1e-300));
        const Row along = t * c.by_a + c.from_a;
        unite_low(all, within.met, along - half, facing);
        unite_high(all, within.met, along + half, facing);
    }
};

/// Ends of the stretch: at the first or last moment, or where it stands still. Source: as
/// extent_with_root has it.
HWY_INLINE void add_cone_across(const ElementLanes& sloped, const Row& u, double v, Swept& all) {
    const AcrossLanes& c = sloped.across;
    const ProfileElement& e = sloped.element;
    const auto [s, z] = aside_and_above(c, u, v);
    const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    const GrowingCircles circles{c, (z - e.z0) * slope + e.r0, s, -slope * c.by_z,
                                 1.0 / (1.0 + slope * slope)};
    const double by = circles.by_radius;
    Moments at{row_of(0.0), row_of(1.0), at_most(row_of(0.0), row_of(0.0))};
    narrow(z, row_of(e.z0), row_of(e.z1), c.per_z, at);
    keep_where_positive(circles.radius - s, by + c.by_side, at);
    keep_where_positive(circles.radius + s, by - c.by_side, at);
    at.met = at.met & at_most(at.first, at.last);
    if (!any(at.met)) return;
    circles.offer(at.first, at, all);
    circles.offer(at.last, at, all);
    const double k = c.by_a * c.by_a, a = by * by - c.by_side * c.by_side;
    if (k < a) return;
    const Row b = circles.radius * by + s * c.by_side;
    const Row under = (circles.radius - s) * (circles.radius + s);
    const Row spread = root(b * b - under * a) * std::sqrt(k * (k - a));
    const Row minus_b = b * (k - a);
    const Row far = choose(at_most(row_of(0.0), minus_b), minus_b + spread, minus_b - spread);
    const RowMask none = at_most(far, row_of(0.0)) & at_most(row_of(0.0), far);
    if (std::abs(a * (a - k)) > 1e-280) circles.offer(far * (1.0 / (a * (a - k))), at, all);
    circles.offer((b * b - under * k) / choose(none, row_of(1.0), far), at, all);
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#endif

// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_SLOPE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_SLOPE_H
#undef FEELER_LANE_SLOPE_H
#else
#define FEELER_LANE_SLOPE_H
#endif

#include "core/dbm/lane_row.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

/// Times of a move, first .. last for each line; valid if `met`.
struct Moments {
    Row first, last;
    RowMask met;
};

/// Narrows the times to those at which the offset of the line from a point in uniform motion,
/// initially `offset`, is within low .. high; `per` is 1 / the point's travel.
HWY_INLINE void narrow(const Row& offset, const Row& low, const Row& high, double per,
                       Moments& at) {
    const Row one = (offset - low) * per, other = (offset - high) * per;
    at.first = most(at.first, least(one, other));
    at.last = least(at.last, most(one, other));
}

/// Offsets of lines along X or Y from the start position of a circle: sideways and in height.
struct CircleOffset {
    Row s, z;
};

HWY_INLINE CircleOffset aside_and_above(const AcrossLanes& c, const Row& u, double v) {
    return {(c.side_is_u ? u : row_of(v)) - c.from_side, (c.side_is_u ? row_of(v) : u) - c.from_z};
}

/// Adds what circles of these radii sweep on lines at the sideways offset `s`, during these times.
/// `flatness` is the square of the component of the surface normal in the plane of the circles.
HWY_INLINE void add_circles(const AcrossLanes& c, const Row& s, const Row& radius,
                            const Row& flatness, Moments at, Swept& all) {
    const Row other_side = row_of(0.0) - radius;
    if (c.per_side == 0.0)
        at.met = at.met & at_most(other_side, s) & at_most(s, radius);
    else
        narrow(s, other_side, radius, c.per_side, at);
    const RowMask met = at.met & at_most(at.first, at.last);
    if (!any(met)) return;
    const auto half = [&](const Row& t) HWY_ATTR {
        const Row aside = s - t * c.by_side;
        return root((radius - aside) * (aside + radius));
    };
    const Row touching = s * c.per_side, shift = radius * c.by_radius;
    const Row low = least(most(touching + c.low_at - shift, at.first), at.last);
    const Row high = least(most(touching + c.high_at + shift, at.first), at.last);
    const Row before = half(low), far_half = half(high);
    const Row per_square = flatness / most(radius * radius, row_of(1e-300));
    unite_low(all, met, low * c.by_a + c.from_a - before, before * before * per_square);
    unite_high(all, met, high * c.by_a + c.from_a + far_half, far_half * far_half * per_square);
}

HWY_INLINE void add_across(const AcrossLanes& c, const Row& u, double v, Swept& all) {
    const auto [s, z] = aside_and_above(c, u, v);
    Moments at{row_of(0.0), row_of(1.0), {}};
    if (c.per_z == 0.0) {
        at.met = at_most(row_of(c.z0 + std::min(0.0, c.by_z)), z)
                 & at_most(z, row_of(c.z1 + std::max(0.0, c.by_z)));
    } else {
        at.met = at_most(at.first, at.last);
        narrow(z, row_of(c.z0), row_of(c.z1), c.per_z, at);
    }
    add_circles(c, s, row_of(c.radius), row_of(1.0), at, all);
}

HWY_INLINE void add_level_across(const ElementLanes& level, const Row& u, double v, Swept& all) {
    const AcrossLanes& c = level.across;
    const ProfileElement& e = level.element;
    const auto [s, z] = aside_and_above(c, u, v);
    // The heights of the piece that pass the line: one, or a range on a move up or down.
    const Row low = z - std::max(0.0, c.by_z), high = z - std::min(0.0, c.by_z);
    Moments at{row_of(0.0), row_of(1.0), {}};
    if (e.margin > 0.0) {
        const Row off = most(most(low - e.z0, row_of(e.z0) - high), row_of(0.0));
        const Row under = (row_of(e.margin) - off) * (off + e.margin);
        at.met = at_most(row_of(0.0), under);
        if (any(at.met))
            add_circles(c, s, root(under) + std::max(e.r0, e.r1),
                        under * (1.0 / (e.margin * e.margin)), at, all);
        return;
    }
    const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    const Row lowest = most(low, row_of(e.z0)), highest = least(high, row_of(e.z1));
    at.met = at_most(lowest, highest);
    if (any(at.met))
        add_circles(c, s, ((slope > 0.0 ? highest : lowest) - e.z0) * slope + e.r0,
                    row_of(1.0 / (1.0 + slope * slope)), at, all);
}

/// A rounded disc on a move up or down, crossed by lines along X or Y. At each time its section is
/// a circle with the half chord S(t).
struct RoundedCircles {
    const AcrossLanes& c;
    Row s, z; // offsets of the lines; z from the disc's plane, at the start
    double radius, margin;

    /// The circle at times t: its half chord S and the derivatives of S by t.
    struct Here {
        Row half, facing;
        Row push, bend; // S S' and S S''
        Row towards;    // derivative of the distance by which the circle extends past the line
        RowMask inside; // whether the line meets the circle
    };
    HWY_INLINE Here at(const Row& t) const {
        const Row height = z - t * c.by_z, aside = s - t * c.by_side;
        const Row f = root((row_of(margin) - height) * (height + margin));
        const Row per_f = row_of(1.0) / most(f, row_of(1e-9 * margin));
        const Row rise = height * c.by_z * per_f;
        const Row r = f + radius;
        const Row under = (r - aside) * (r + aside);
        Here here;
        here.inside = at_most(row_of(0.0), under);
        here.half = root(under);
        here.push = r * rise + aside * c.by_side;
        const Row slope = here.push / most(here.half, row_of(1e-9 * margin));
        const Row square = rise * rise;
        here.bend = square - r * (square + c.by_z * c.by_z) * per_f - row_of(c.by_side * c.by_side)
                    - slope * slope;
        here.towards =
            rise + choose(at_most(row_of(0.0), aside), row_of(c.by_side), row_of(-c.by_side));
        const Row flat = f * here.half * (1.0 / margin) / r;
        here.facing = flat * flat;
        return here;
    }

    HWY_INLINE void offer(const Row& t, const Here& here, const RowMask& met, Swept& all) const {
        const Row along = t * c.by_a + c.from_a;
        unite_low(all, met & here.inside, along - here.half, here.facing);
        unite_high(all, met & here.inside, along + here.half, here.facing);
    }
};

/// Adds the maximum of sign * by_a * t + S(t), a concave function, by Newton's method within a
/// bracket. Every iterate is inside the swept volume.
HWY_ATTR void search_round(const RoundedCircles& circles, const Moments& within, double sign,
                           Swept& all) {
    constexpr int rounds = 50; // six are enough unless a line only grazes the body
    const double by = sign * circles.c.by_a;
    Row low = within.first, high = within.last;
    Row t = (low + high) * 0.5;
    for (int i = 0; i < rounds; ++i) {
        const RoundedCircles::Here here = circles.at(t);
        circles.offer(t, here, within.met, all);
        const Row change = here.push + here.half * by;
        const RowMask later = below(row_of(0.0), choose(here.inside, change, here.towards));
        low = choose(later, t, low);
        high = choose(later, high, t);
        const Row next = t - change / least(here.bend, row_of(-1e-300));
        // At the edge of the circle the step is far too short.
        const RowMask good = here.inside & below(row_of(1e-5 * circles.margin), here.half)
                             & below(low, next) & below(next, high);
        const Row before = t;
        t = choose(good, next, (low + high) * 0.5);
        // A change of time this small has no effect along the line.
        const RowMask moved = below(row_of(1e-14), (t - before) * (t - before));
        if (!any(within.met & moved)) break;
    }
    circles.offer(t, circles.at(t), within.met, all);
}

HWY_INLINE void add_round_across(const ElementLanes& sloped, const Row& u, double v, Swept& all) {
    const AcrossLanes& c = sloped.across;
    const ProfileElement& e = sloped.element;
    const auto [s, z] = aside_and_above(c, u, v);
    const RoundedCircles circles{c, s, z - e.z0, std::max(e.r0, e.r1), e.margin};
    Moments within{row_of(0.0), row_of(1.0), {}};
    narrow(circles.z, row_of(-e.margin), row_of(e.margin), c.per_z, within);
    within.met = at_most(within.first, within.last);
    if (!any(within.met)) return;
    for (const Row& t : {within.first, within.last})
        circles.offer(t, circles.at(t), within.met, all);
    search_round(circles, within, -1.0, all);
    search_round(circles, within, 1.0, all);
}

/// An end of an element's segment on lines along Z, and the facing of the surface there.
struct SweepEnd {
    Row at, facing;
};

HWY_INLINE SweepEnd lower_end(const ProfileElement& e, const Row& away) {
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

/// The element upside down: its upper end becomes a lower end with the opposite sign.
ProfileElement turned_over(const ProfileElement& e) { return {-e.z1, e.r1, -e.z0, e.r0, e.margin}; }

/// For a rounded disc on a move up or down, the distance ahead of the axis at which it touches the
/// surface that it leaves, on lines at the distance `aside` from its path. There the normal is
/// perpendicular to the motion.
///
/// Source: with the sine of the normal's angle from the axis, the circle has the radius
///         d = r + m sine, and aside^2 = d^2 (1 + k^2 - k^2 / sine^2), k the move's slope. Solved
///         by Newton's method; an error in position is of second order in height.
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

/// The same distance for the lower end of a cone. If that is flat, the foremost point of its face;
/// if the move is steeper than its flank, the foremost point of its rim.
HWY_INLINE Row ahead_of_cone(const ProfileElement& e, const Row& aside, double slope) {
    const double cosine = std::abs(slope) * (e.r1 - e.r0) / (e.z1 - e.z0);
    if (e.r1 < e.r0 || cosine >= 1.0) return row_of(infinity);
    const Row flank =
        most(aside, row_of(0.0) - aside) * (cosine / std::sqrt(1.0 - cosine * cosine));
    return most(flank, root((row_of(e.r0) - aside) * (aside + e.r0)));
}

/// Lower ends of the segments that a cone or a rounded disc sweeps on lines along Z, on a move up
/// or down.
struct LowerEnds {
    SweepEnd end;
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
    // Distances of the line ahead of the axis while the element meets it.
    const Row first = most(row_of(0.0) - rim, g - c.length), last = least(rim, g);
    LowerEnds found;
    found.met = at_most(first, last) & at_most(row_of(0.0), beyond);
    if (!any(found.met)) return found;
    const double slope = by_z * c.per_length;
    const Row touch =
        e.margin > 0.0 ? ahead_of_round(e, aside, slope) : ahead_of_cone(e, aside, slope);
    // The lower end is a convex function of time, so a minimum outside the move is replaced by the
    // move's end.
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

/// Narrows the times to those at which at + t * by is not negative.
HWY_INLINE void add_where_positive(const Row& at, double by, Moments& moments) {
    constexpr double least_change = 1e-12; // a smaller change is ignored; the error is no larger
    if (std::abs(by) <= least_change)
        moments.met = moments.met & at_most(row_of(0.0), at);
    else if (by > 0.0)
        moments.first = most(moments.first, at * (-1.0 / by));
    else
        moments.last = least(moments.last, at * (-1.0 / by));
}

/// A circle that moves and grows uniformly, crossed by lines in its plane.
struct GrowingCircles {
    const AcrossLanes& c;
    Row radius, s; // at the start
    double by_radius, flatness;

    /// Adds the segments of the lines at these times.
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

/// Extremes of the segment: at the first or last time, or at a stationary point. Source: see
/// extent_with_root.
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
    add_where_positive(circles.radius - s, by + c.by_side, at);
    add_where_positive(circles.radius + s, by - c.by_side, at);
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

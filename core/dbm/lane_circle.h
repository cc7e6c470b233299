// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_CIRCLE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_CIRCLE_H
#undef FEELER_LANE_CIRCLE_H
#else
#define FEELER_LANE_CIRCLE_H
#endif

#include "core/dbm/lane_stretch.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

/// Moments of a move, first .. last for each line, while `met`.
struct Moments {
    Row first, last;
    RowMask met;
};

/// Narrows the moments to those at which a point that moves evenly, and stands at `offset` from it,
/// lies within low .. high; `per` is 1 / its way.
HWY_INLINE void narrow(const Row& offset, const Row& low, const Row& high, double per,
                       Moments& at) {
    const Row one = (offset - low) * per, other = (offset - high) * per;
    at.first = most(at.first, least(one, other));
    at.last = least(at.last, most(one, other));
}

/// Where lines along X or Y lie from where a circle starts: beside it and above it.
struct AsideAndAbove {
    Row s, z;
};

HWY_INLINE AsideAndAbove aside_and_above(const AcrossLanes& c, const Row& u, double v) {
    return {(c.side_is_u ? u : row_of(v)) - c.from_side, (c.side_is_u ? row_of(v) : u) - c.from_z};
}

/// Circles of these radii, a line at `s` beside each, during these moments; `flatness` is the
/// square of the part of the surface's normal that lies in their plane.
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
    const Row before = half(low), behind = half(high);
    const Row per_square = flatness / most(radius * radius, row_of(1e-300));
    unite_low(all, met, low * c.by_a + c.from_a - before, before * before * per_square);
    unite_high(all, met, high * c.by_a + c.from_a + behind, behind * behind * per_square);
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
    // The heights of the piece that come by: one, or a stretch on the way up or down.
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

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#endif

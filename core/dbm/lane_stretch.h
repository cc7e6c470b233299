// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_STRETCH_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_STRETCH_H
#undef FEELER_LANE_STRETCH_H
#else
#define FEELER_LANE_STRETCH_H
#endif

#include "core/dbm/lane_plan.h"
#include "core/dbm/lane_row.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

struct Stretch {
    Row lower, upper;
};

/// What is swept of a row of lines, and how far its ends face along the lines: the square of that
/// component of the normal, 1 where it is not known.
struct Swept {
    Stretch ends;
    Row low_facing, high_facing;
};

HWY_INLINE Swept nothing_swept() {
    return {{row_of(infinity), row_of(-infinity)}, row_of(1.0), row_of(1.0)};
}

HWY_INLINE void unite_low(Swept& all, const RowMask& valid, const Row& at, const Row& facing) {
    const RowMask lower = valid & below(at, all.ends.lower);
    all.ends.lower = choose(lower, at, all.ends.lower);
    all.low_facing = choose(lower, facing, all.low_facing);
}

HWY_INLINE void unite_high(Swept& all, const RowMask& valid, const Row& at, const Row& facing) {
    const RowMask higher = valid & below(all.ends.upper, at);
    all.ends.upper = choose(higher, at, all.ends.upper);
    all.high_facing = choose(higher, facing, all.high_facing);
}

/// Where lines lie, seen along them, from the path of a capsule.
struct Beside {
    Row g, beyond; // along the path; w^2
    RowMask met;
};

HWY_INLINE Beside beside(const CapsuleLanes& c, const Row& u, double v) {
    const Row ou = u - c.from_u;
    const double ov = v - c.from_v;
    const Row g = ou * c.cos_u + ov * c.cos_v;
    const Row e = ou * c.cos_v - ov * c.cos_u;
    const Row beyond = (row_of(c.radius) - e) * (e + c.radius);
    const Row past = g - within_move(g * c.per_length) * c.length;
    return {g, beyond, at_most(past * past, beyond)};
}

HWY_INLINE Row moment(const CapsuleLanes& c, const Beside& at, const Row& half, double by_half,
                      double offset) {
    return within_move(at.g * c.per_length + half * by_half + offset);
}

HWY_INLINE void add_ball(const CapsuleLanes& c, const Row& u, double v, Swept& all) {
    const Beside at = beside(c, u, v);
    const auto deep = [&](const Row& t) HWY_ATTR {
        const Row past = at.g - t * c.length;
        return root(at.beyond - past * past);
    };
    // Where the surface is lowest or highest, a little off in time is nothing in height.
    const Row half = rough_root(at.beyond);
    const Row t = moment(c, at, half, c.low_by_half, c.low_at);
    const double per_square = 1.0 / (c.radius * c.radius);
    const Row low = deep(t);
    unite_low(all, at.met, t * c.by_a + c.from_a - low, low * low * per_square);
    if (c.opens_up) {
        unite_high(all, at.met, row_of(c.high_end), row_of(1.0));
        return;
    }
    const Row last = moment(c, at, half, c.high_by_half, c.high_at);
    const Row high = deep(last);
    unite_high(all, at.met, last * c.by_a + c.from_a + high, high * high * per_square);
}

HWY_INLINE void add_upright(const CapsuleLanes& c, const Row& u, double v, Swept& all) {
    const Beside at = beside(c, u, v);
    const Row half = root(at.beyond);
    const Row low = moment(c, at, half, c.low_by_half, c.low_at) * c.by_a + (c.from_a + c.low_end);
    unite_low(all, at.met, low, row_of(1.0));
    if (c.opens_up) {
        unite_high(all, at.met, row_of(c.high_end), row_of(1.0));
        return;
    }
    const Row last = moment(c, at, half, c.high_by_half, c.high_at);
    unite_high(all, at.met, last * c.by_a + (c.from_a + c.high_end), row_of(1.0));
}

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
    const Row s = (c.side_is_u ? u : row_of(v)) - c.from_side;
    const Row z = (c.side_is_u ? row_of(v) : u) - c.from_z;
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

HWY_INLINE void add_level_across(const LevelLanes& level, const Row& u, double v, Swept& all) {
    const AcrossLanes& c = level.across;
    const ProfileElement& e = level.element;
    const Row s = (c.side_is_u ? u : row_of(v)) - c.from_side;
    const Row z = (c.side_is_u ? row_of(v) : u) - c.from_z;
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

HWY_INLINE void add_level_along(const LevelLanes& level, const Row& u, double v, Swept& all) {
    const CapsuleLanes& c = level.path;
    const ProfileElement& e = level.element;
    const Row ou = u - c.from_u;
    const double ov = v - c.from_v;
    const Row g = ou * c.cos_u + row_of(ov * c.cos_v);
    const Row aside = ou * c.cos_v - row_of(ov * c.cos_u);
    const Row past = g - within_move(g * c.per_length) * c.length;
    const Row away = root(aside * aside + past * past);
    const RowMask met = at_most(away, row_of(c.radius));
    const double lowest = c.from_a + std::min(0.0, c.by_a);
    const double highest = c.from_a + std::max(0.0, c.by_a);
    if (e.margin > 0.0) {
        const Row beyond = most(away - std::max(e.r0, e.r1), row_of(0.0));
        const Row half = root((row_of(e.margin) - beyond) * (beyond + e.margin));
        const Row facing = half * half * (1.0 / (e.margin * e.margin));
        unite_low(all, met, row_of(lowest + e.z0) - half, facing);
        unite_high(all, met, half + (highest + e.z0), facing);
        return;
    }
    const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    const Row slant = (away - e.r0) * (1.0 / slope) + e.z0;
    const Row inside = least(most(slant, row_of(e.z0)), row_of(e.z1));
    const Row leans = row_of(slope * slope / (1.0 + slope * slope));
    const Row facing = choose(at_most(slant, inside) & at_most(inside, slant), leans, row_of(1.0));
    const Row flat = row_of(1.0);
    const bool widens = slope > 0.0;
    unite_low(all, met, (widens ? inside : row_of(e.z0)) + lowest, widens ? facing : flat);
    unite_high(all, met, (widens ? row_of(e.z1) : inside) + highest, widens ? flat : facing);
}

HWY_INLINE void add_level(const LanePlan& plan, const LevelLanes& level, const Row& u, double v,
                          Swept& all) {
    if (plan.axis == 2)
        add_level_along(level, u, v, all);
    else
        add_level_across(level, u, v, all);
}

/// Line by line, for shapes and moves that have no lanes of their own.
Swept swept_one_by_one(const LanePlan& plan, const double* u, double v, uint32_t wanted) {
    RowStretches out;
    for (size_t i = 0; i < side; ++i) {
        const bool asked = (wanted >> i) & 1U;
        const auto found =
            asked ? line_interval(*plan.piece, *plan.sweep, plan.axis, u[i], v) : std::nullopt;
        out.lower[i] = found ? found->lower : infinity;
        out.upper[i] = found ? found->upper : -infinity;
    }
    return {{load(out.lower.data()), load(out.upper.data())}, row_of(1.0), row_of(1.0)};
}

/// Ends are put on a lattice of 2.3e-10 mm: two moves that leave the same surface then leave the
/// same bits, and neither cuts a rounding error from the other's.
HWY_INLINE Row on_lattice(const Row& x) {
    constexpr double per_mm = 4294967296.0; // 2^32
    const Row scaled = x * per_mm;
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Round(scaled.part[k]); }) * (1.0 / per_mm);
}

/// What the plan sweeps on a row of lines; those that are not wanted may come out empty.
HWY_INLINE Swept swept_of(const LanePlan& plan, const double* u, double v, uint32_t wanted) {
    Swept all = plan.by_lanes ? nothing_swept() : swept_one_by_one(plan, u, v, wanted);
    const Row at_u = load(u);
    for (size_t i = 0; i < plan.balls; ++i) {
        const CapsuleLanes& c = plan.ball[i];
        if (u[0] <= c.u_most && v <= c.v_most) add_ball(c, at_u, v, all);
    }
    for (size_t i = 0; i < plan.uprights; ++i) add_upright(plan.upright[i], at_u, v, all);
    for (size_t i = 0; i < plan.across; ++i) add_across(plan.beside[i], at_u, v, all);
    for (size_t i = 0; i < plan.levels; ++i) add_level(plan, plan.level[i], at_u, v, all);
    all.ends = {on_lattice(all.ends.lower), on_lattice(all.ends.upper)};
    return all;
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#endif

// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_SWEEP_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_SWEEP_H
#undef FEELER_LANE_SWEEP_H
#else
#define FEELER_LANE_SWEEP_H
#endif

#include "core/dbm/lane_cut.h"
#include "core/dbm/lane_row.h"
#include "core/dbm/lane_slope.h"
#include "core/dbm/lane_tilt.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

HWY_INLINE void add_level_along(const ElementLanes& level, const Row& u, double v, Swept& all) {
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

/// Adds what the element sweeps; with `loosely`, an enclosing volume for sloped moves.
HWY_INLINE void add_element(const LanePlan& plan, const ElementLanes& element, bool loosely,
                            const Row& u, double v, Swept& all) {
    const bool sloped = element.sloped && !loosely;
    if (plan.axis == 2)
        sloped ? add_slope_along(element, u, v, all) : add_level_along(element, u, v, all);
    else if (!sloped)
        add_level_across(element, u, v, all);
    else if (element.element.margin > 0.0)
        add_round_across(element, u, v, all);
    else
        add_cone_across(element, u, v, all);
}

/// The least and the greatest distance of a chunk of lines along Z from the axis of the tool.
HWY_ATTR Interval distances_from_axis(const CapsuleLanes& c, const Row& u, double v) {
    const Row ou = u - c.from_u;
    const double ov = v - c.from_v;
    const Row g = ou * c.cos_u + row_of(ov * c.cos_v);
    const Row aside = ou * c.cos_v - row_of(ov * c.cos_u);
    const Row past = g - within_move(g * c.per_length) * c.length;
    const Row ahead = g - c.length;
    alignas(64) std::array<double, chunk> nearest, farthest;
    store(aside * aside + past * past, nearest.data());
    store(aside * aside + most(g * g, ahead * ahead), farthest.data());
    return {std::sqrt(*std::min_element(nearest.begin(), nearest.end())),
            std::sqrt(*std::max_element(farthest.begin(), farthest.end()))};
}

/// The distances from the axis, or the heights, of a chunk of lines (see ElementLanes::matters).
HWY_INLINE Interval places_of(const LanePlan& plan, const double* u, const Row& at_u, double v) {
    if (plan.axis == 2) return distances_from_axis(plan.elements[0].path, at_u, v);
    if (plan.axis == 0) return {v, v};
    const auto [low, high] = std::minmax_element(u, u + chunk);
    return {*low, *high};
}

/// Adds what the cones and rounded corners of the plan sweep.
HWY_INLINE void add_elements(const LanePlan& plan, bool loosely, const double* u, const Row& at_u,
                             double v, Swept& all) {
    if (plan.elements.empty()) return;
    constexpr double slack = 1e-9; // mm
    const Interval places = places_of(plan, u, at_u, v);
    for (const ElementLanes& element : plan.elements)
        if (element.matters.lower - slack <= places.upper
            && element.matters.upper + slack >= places.lower)
            add_element(plan, element, loosely, at_u, v, all);
}

/// What the plan sweeps, line by line, for shapes and moves without a lane version.
HWY_ATTR Swept swept_one_by_one(const LanePlan& plan, const double* u, double v, uint32_t wanted) {
    alignas(64) std::array<double, chunk> lower, upper;
    for (size_t i = 0; i < chunk; ++i) {
        const bool asked = (wanted >> i) & 1U;
        const auto found =
            asked ? line_interval(*plan.piece, *plan.sweep, plan.axis, u[i], v) : std::nullopt;
        lower[i] = found ? found->lower : infinity;
        upper[i] = found ? found->upper : -infinity;
    }
    return {{load(lower.data()), load(upper.data())}, row_of(1.0), row_of(1.0)};
}

/// Rounds ends, see ends_per_mm.
HWY_INLINE Row on_lattice(const Row& x) {
    const Row scaled = x * ends_per_mm;
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Round(scaled.part[k]); })
           * (1.0 / ends_per_mm);
}

/// What the plan sweeps on a chunk of lines; lines that are not wanted may come out empty.
HWY_ATTR Swept swept_of(const LanePlan& plan, const double* u, double v, uint32_t wanted) {
    Swept all = plan.by_lanes ? empty_sweep() : swept_one_by_one(plan, u, v, wanted);
    const Row at_u = load(u);
    for (size_t i = 0; i < plan.balls; ++i) {
        const CapsuleLanes& c = plan.ball[i];
        if (u[0] <= c.u_most && v <= c.v_most) add_ball(c, at_u, v, all);
    }
    for (size_t i = 0; i < plan.uprights; ++i) add_upright(plan.upright[i], at_u, v, all);
    for (size_t i = 0; i < plan.across; ++i) add_across(plan.sideways[i], at_u, v, all);
    for (const TiltedLanes& cone : plan.tilted) add_tilted(cone, at_u, v, all);
    add_elements(plan, false, u, at_u, v, all);
    all.ends = {on_lattice(all.ends.lower), on_lattice(all.ends.upper)};
    return all;
}

/// The swept segments of a chunk of lines are within low - w .. high + w, w^2 = square: an
/// enclosing range that needs no square root.
struct Reach {
    Row square;
    double low, high;
    RowMask met;
    bool is_exact = false; // the segments are low .. high
};

/// Whether the range may contain material, allowing for rounding.
HWY_INLINE RowMask may_hold(const Reach& reach, const Stretch& matter) {
    if (reach.is_exact) return reach.met & overlap({row_of(reach.low), row_of(reach.high)}, matter);
    constexpr double slack = 1e-6; // mm^2: 1e-9 mm at the end of a tool of 1 m
    const Row off =
        most(most(row_of(reach.low) - matter.upper, matter.lower - reach.high), row_of(0.0));
    return reach.met & below(off * off, reach.square + slack);
}

HWY_INLINE Reach reach_of_ball(const CapsuleLanes& c, const Row& u, double v) {
    const Sideways at = sideways(c, u, v);
    return {at.beyond - at.past * at.past, c.reach_low, c.reach_high, at.met};
}

/// Without exact ends, the floor and the slot that a level move has just made would be in reach.
HWY_INLINE Reach reach_of_upright(const CapsuleLanes& c, const Row& u, double v, double less) {
    return {row_of(0.0), c.reach_low + less, c.reach_high - less, sideways(c, u, v).met, c.level};
}

HWY_INLINE Reach reach_of_circles(const AcrossLanes& c, const Row& u, double v) {
    constexpr double slack = 1e-6;
    const auto [s, z] = aside_and_above(c, u, v);
    const Row aside = s - within_move(s * c.per_side) * c.by_side;
    return {(row_of(c.radius) - aside) * (aside + c.radius), c.reach_low, c.reach_high,
            at_most(row_of(c.z0 + std::min(0.0, c.by_z) - slack), z)
                & at_most(z, row_of(c.z1 + std::max(0.0, c.by_z) + slack))};
}

/// Calls `act` with a reach of each ball and cylinder of the plan; exact ones are shortened by
/// `less` at both ends.
template <typename Act>
HWY_INLINE void for_reaches(const LanePlan& plan, const double* u, const Row& at_u, double v,
                            double less, const Act& act) {
    for (size_t i = 0; i < plan.balls; ++i) {
        const CapsuleLanes& c = plan.ball[i];
        if (u[0] <= c.u_most && v <= c.v_most) act(reach_of_ball(c, at_u, v));
    }
    for (size_t i = 0; i < plan.uprights; ++i)
        act(reach_of_upright(plan.upright[i], at_u, v, less));
    for (size_t i = 0; i < plan.across; ++i) act(reach_of_circles(plan.sideways[i], at_u, v));
}

/// What the plan sweeps at most, from its lowest to its highest end on each line: elements between
/// them may have been left out.
HWY_INLINE Stretch loose_hull(const LanePlan& plan, const double* u, const Row& at_u, double v) {
    constexpr double slack = 1e-6;
    Swept loose = empty_sweep();
    add_elements(plan, true, u, at_u, v, loose);
    for_reaches(plan, u, at_u, v, 0.0, [&](const Reach& reach) HWY_ATTR {
        const RowMask met = reach.met & at_most(row_of(-slack), reach.square);
        const Row half = root(reach.square);
        unite_low(loose, met, row_of(reach.low) - half, row_of(1.0));
        unite_high(loose, met, half + reach.high, row_of(1.0));
    });
    return {loose.ends.lower - slack, loose.ends.upper + slack};
}

/// The part of each line within the slabs of the plan.
struct Within {
    Stretch range;
    RowMask met;
};

HWY_INLINE Within within_slabs(const LanePlan& plan, const Row& u, double v) {
    Within box{{row_of(-infinity), row_of(infinity)}, at_most(row_of(0.0), row_of(0.0))};
    for (const SlabLanes& slab : plan.slabs) {
        const Row across = u * slab.normal_u + row_of(v * slab.normal_v);
        if (slab.per_a == 0.0) {
            box.met =
                box.met & at_most(row_of(slab.low), across) & at_most(across, row_of(slab.high));
            continue;
        }
        const Row one = (row_of(slab.low) - across) * slab.per_a;
        const Row other = (row_of(slab.high) - across) * slab.per_a;
        box.range.lower = most(box.range.lower, least(one, other));
        box.range.upper = least(box.range.upper, most(one, other));
    }
    box.met = box.met & below(box.range.lower, box.range.upper);
    return box;
}

/// The lines of a chunk on which the plan may sweep material; `holds(test)` runs a test of a
/// segment over all material. `less`: the swept segments are shortened by it at both ends.
template <typename Holds>
HWY_INLINE RowMask in_reach(const LanePlan& plan, const double* u, double v, double less,
                            const Holds& holds) {
    const RowMask all = at_most(row_of(0.0), row_of(0.0));
    const Row at_u = load(u);
    if (plan.has_slabs) {
        const Within box = within_slabs(plan, at_u, v);
        return box.met
               & holds([&](const Stretch& matter) HWY_ATTR { return overlap(box.range, matter); });
    }
    if (!plan.elements.empty()) {
        const Stretch hull = loose_hull(plan, u, at_u, v);
        return holds([&](const Stretch& matter) HWY_ATTR { return overlap(hull, matter); });
    }
    RowMask found = but_not(all, all);
    for_reaches(plan, u, at_u, v, less, [&](const Reach& reach) HWY_ATTR {
        found =
            found | holds([&](const Stretch& matter) HWY_ATTR { return may_hold(reach, matter); });
    });
    return found;
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#endif

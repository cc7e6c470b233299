// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_SWEEP_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_SWEEP_H
#undef FEELER_LANE_SWEEP_H
#else
#define FEELER_LANE_SWEEP_H
#endif

#include "core/dbm/lane_cut.h"
#include "core/dbm/lane_round.h"
#include "core/dbm/lane_slope.h"

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

/// What the element sweeps; with `loosely`, more than a move that climbs or sinks really does.
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

/// Line by line, for shapes and moves that have no lanes of their own.
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

/// Ends are put on a lattice of 2.3e-10 mm: two moves that leave the same surface then leave the
/// same bits, and neither cuts a rounding error from the other's.
HWY_INLINE Row on_lattice(const Row& x) {
    constexpr double per_mm = 4294967296.0; // 2^32
    const Row scaled = x * per_mm;
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Round(scaled.part[k]); }) * (1.0 / per_mm);
}

/// What the plan sweeps on a chunk of lines; those that are not wanted may come out empty.
HWY_ATTR Swept swept_of(const LanePlan& plan, const double* u, double v, uint32_t wanted) {
    Swept all = plan.by_lanes ? nothing_swept() : swept_one_by_one(plan, u, v, wanted);
    const Row at_u = load(u);
    for (size_t i = 0; i < plan.balls; ++i) {
        const CapsuleLanes& c = plan.ball[i];
        if (u[0] <= c.u_most && v <= c.v_most) add_ball(c, at_u, v, all);
    }
    for (size_t i = 0; i < plan.uprights; ++i) add_upright(plan.upright[i], at_u, v, all);
    for (size_t i = 0; i < plan.across; ++i) add_across(plan.beside[i], at_u, v, all);
    for (size_t i = 0; i < plan.elements; ++i)
        add_element(plan, plan.element[i], false, at_u, v, all);
    all.ends = {on_lattice(all.ends.lower), on_lattice(all.ends.upper)};
    return all;
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#endif

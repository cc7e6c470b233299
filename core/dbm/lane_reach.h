// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_REACH_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_REACH_H
#undef FEELER_LANE_REACH_H
#else
#define FEELER_LANE_REACH_H
#endif

#include "core/dbm/lane_sweep.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

/// What is swept of a chunk of lines lies within low - w .. high + w, w^2 = square: more than is
/// really swept, but to be had without a root.
struct Reach {
    Row square;
    double low, high;
    RowMask met;
};

/// Whether matter may lie in it, whatever the rounding of what will be computed.
HWY_INLINE RowMask may_hold(const Reach& reach, const Stretch& matter) {
    constexpr double slack = 1e-6; // mm^2: 1e-9 mm at the end of a tool of 1 m
    const Row off =
        most(most(row_of(reach.low) - matter.upper, matter.lower - reach.high), row_of(0.0));
    return reach.met & below(off * off, reach.square + slack);
}

HWY_INLINE Reach reach_of_ball(const CapsuleLanes& c, const Row& u, double v) {
    const Beside at = beside(c, u, v);
    return {at.beyond - at.past * at.past, c.reach_low, c.reach_high, at.met};
}

HWY_INLINE Reach reach_of_upright(const CapsuleLanes& c, const Row& u, double v) {
    return {row_of(0.0), c.reach_low, c.reach_high, beside(c, u, v).met};
}

HWY_INLINE Reach reach_of_circles(const AcrossLanes& c, const Row& u, double v) {
    constexpr double slack = 1e-6;
    const auto [s, z] = aside_and_above(c, u, v);
    const Row aside = s - within_move(s * c.per_side) * c.by_side;
    return {(row_of(c.radius) - aside) * (aside + c.radius), c.reach_low, c.reach_high,
            at_most(row_of(c.z0 + std::min(0.0, c.by_z) - slack), z)
                & at_most(z, row_of(c.z1 + std::max(0.0, c.by_z) + slack))};
}

/// The lines of a chunk on which the plan may sweep matter; `holds(test)` runs a test of a stretch
/// over all matter there is.
template <typename Holds>
HWY_INLINE RowMask in_reach(const LanePlan& plan, const double* u, double v, const Holds& holds) {
    const RowMask all = at_most(row_of(0.0), row_of(0.0));
    if (!plan.by_lanes) return all;
    const Row at_u = load(u);
    RowMask found = but_not(all, all);
    const auto add = [&](const Reach& reach) HWY_ATTR {
        found =
            found | holds([&](const Stretch& matter) HWY_ATTR { return may_hold(reach, matter); });
    };
    for (size_t i = 0; i < plan.balls; ++i) {
        const CapsuleLanes& c = plan.ball[i];
        if (u[0] <= c.u_most && v <= c.v_most) add(reach_of_ball(c, at_u, v));
    }
    for (size_t i = 0; i < plan.uprights; ++i) add(reach_of_upright(plan.upright[i], at_u, v));
    for (size_t i = 0; i < plan.across; ++i) add(reach_of_circles(plan.beside[i], at_u, v));
    if (plan.elements == 0) return found;
    Swept loose = nothing_swept();
    for (size_t i = 0; i < plan.elements; ++i)
        add_element(plan, plan.element[i], true, at_u, v, loose);
    constexpr double slack = 1e-6;
    const Stretch wider{loose.ends.lower - slack, loose.ends.upper + slack};
    return found | holds([&](const Stretch& matter) HWY_ATTR { return overlap(wider, matter); });
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#endif

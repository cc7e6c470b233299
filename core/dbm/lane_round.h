// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_ROUND_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_ROUND_H
#undef FEELER_LANE_ROUND_H
#else
#define FEELER_LANE_ROUND_H
#endif

#include "core/dbm/lane_circle.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

/// A rounded disc on a move that climbs or sinks, met by lines along X or Y: at each moment by a
/// circle, of which the half chord is S(t).
struct RoundedCircles {
    const AcrossLanes& c;
    Row s, z; // of the lines, the height from the disc's plane, at the start
    double radius, margin;

    /// The circle at moments t: its half chord S, how t changes S, and how S bends.
    struct Here {
        Row half, facing;
        Row push, bend; // S S' and S S''
        Row towards;    // the derivative of what the circle reaches past the line
        RowMask inside; // the line meets the circle
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

/// Offers the greatest of sign * by_a * t + S(t), a concave function: Newton's steps within a
/// bracket. Whatever they come to lies in the swept volume.
HWY_ATTR void search_round(const RoundedCircles& circles, const Moments& within, double sign,
                           Swept& all) {
    constexpr int rounds = 50; // half a dozen will do, but where a line only grazes the body
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
        const RowMask good = here.inside & below(low, next) & below(next, high);
        const Row before = t;
        t = choose(good, next, (low + high) * 0.5);
        // Off by this much in time is nothing along the line.
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

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#endif

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

HWY_INLINE RowMask overlap(const Stretch& a, const Stretch& b) {
    return below(a.lower, b.upper) & below(b.lower, a.upper);
}

/// What is swept of a chunk of lines, and how far its ends face along the lines: the square of that
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
    Row past;      // how far before the path or beyond it
    RowMask met;
};

HWY_INLINE Beside beside(const CapsuleLanes& c, const Row& u, double v) {
    const Row ou = u - c.from_u;
    const double ov = v - c.from_v;
    const Row g = ou * c.cos_u + ov * c.cos_v;
    const Row e = ou * c.cos_v - ov * c.cos_u;
    const Row beyond = (row_of(c.radius) - e) * (e + c.radius);
    const Row past = g - within_move(g * c.per_length) * c.length;
    return {g, beyond, past, at_most(past * past, beyond)};
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

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#endif

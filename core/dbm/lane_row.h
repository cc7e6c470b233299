// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_ROW_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_ROW_H
#undef FEELER_LANE_ROW_H
#else
#define FEELER_LANE_ROW_H
#endif

#include <hwy/highway.h>

#include "core/dbm/lane_plan.h"
#include "core/dbm/scan_lines.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Number of lines that are processed together on every instruction set: half a row of a tile.
constexpr size_t chunk = 8;
constexpr size_t chunks = ScanTile::side / chunk;

using Tag = hn::CappedTag<double, 8>;
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

constexpr size_t lanes = hn::MaxLanes(Tag());
constexpr size_t vectors = chunk / lanes;

/// A number for each line of a chunk.
struct Row {
    Vec part[vectors];
};
struct RowMask {
    Mask part[vectors];
};

template <typename Out, typename Act>
HWY_INLINE Out each(const Act& act) {
    Out out;
    for (size_t k = 0; k < vectors; ++k) out.part[k] = act(k);
    return out;
}

HWY_INLINE Vec set(double x) { return hn::Set(Tag(), x); }
HWY_INLINE Row row_of(double x) {
    return each<Row>([&](size_t) HWY_ATTR { return set(x); });
}
HWY_INLINE Row load(const double* from) {
    return each<Row>([&](size_t k) HWY_ATTR { return hn::LoadU(Tag(), from + k * lanes); });
}
HWY_INLINE void store(const Row& row, double* to) {
    for (size_t k = 0; k < vectors; ++k) hn::StoreU(row.part[k], Tag(), to + k * lanes);
}
HWY_INLINE Row operator+(const Row& a, const Row& b) {
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Add(a.part[k], b.part[k]); });
}
HWY_INLINE Row operator-(const Row& a, const Row& b) {
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Sub(a.part[k], b.part[k]); });
}
HWY_INLINE Row operator*(const Row& a, const Row& b) {
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Mul(a.part[k], b.part[k]); });
}
HWY_INLINE Row operator/(const Row& a, const Row& b) {
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Div(a.part[k], b.part[k]); });
}
HWY_INLINE Row operator+(const Row& a, double b) { return a + row_of(b); }
HWY_INLINE Row operator-(const Row& a, double b) { return a - row_of(b); }
HWY_INLINE Row operator*(const Row& a, double b) { return a * row_of(b); }
HWY_INLINE Row least(const Row& a, const Row& b) {
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Min(a.part[k], b.part[k]); });
}
HWY_INLINE Row most(const Row& a, const Row& b) {
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Max(a.part[k], b.part[k]); });
}
HWY_INLINE Row root(const Row& x) {
    return each<Row>([&](size_t k)
                         HWY_ATTR { return hn::Sqrt(hn::Max(x.part[k], hn::Zero(Tag()))); });
}
/// A square root accurate to seven digits, at half the cost.
HWY_INLINE Row rough_root(const Row& x) {
    const hn::Rebind<float, Tag> f;
    return each<Row>([&](size_t k) HWY_ATTR {
        const Vec positive = hn::Max(x.part[k], hn::Zero(Tag()));
        return hn::PromoteTo(Tag(), hn::Sqrt(hn::DemoteTo(f, positive)));
    });
}
HWY_INLINE Row within_move(const Row& t) { return least(most(t, row_of(0.0)), row_of(1.0)); }
HWY_INLINE RowMask at_most(const Row& a, const Row& b) {
    return each<RowMask>([&](size_t k) HWY_ATTR { return hn::Le(a.part[k], b.part[k]); });
}
HWY_INLINE RowMask below(const Row& a, const Row& b) {
    return each<RowMask>([&](size_t k) HWY_ATTR { return hn::Lt(a.part[k], b.part[k]); });
}
HWY_INLINE RowMask operator&(const RowMask& a, const RowMask& b) {
    return each<RowMask>([&](size_t k) HWY_ATTR { return hn::And(a.part[k], b.part[k]); });
}
HWY_INLINE RowMask operator|(const RowMask& a, const RowMask& b) {
    return each<RowMask>([&](size_t k) HWY_ATTR { return hn::Or(a.part[k], b.part[k]); });
}
HWY_INLINE RowMask but_not(const RowMask& a, const RowMask& b) {
    return each<RowMask>([&](size_t k) HWY_ATTR { return hn::AndNot(b.part[k], a.part[k]); });
}
HWY_INLINE Row choose(const RowMask& mask, const Row& yes, const Row& no) {
    return each<Row>(
        [&](size_t k) HWY_ATTR { return hn::IfThenElse(mask.part[k], yes.part[k], no.part[k]); });
}
HWY_INLINE uint32_t bits_of(const RowMask& mask) {
    uint32_t all = 0;
    for (size_t k = 0; k < vectors; ++k) {
        uint8_t byte = 0; // eight lanes at most
        hn::StoreMaskBits(Tag(), mask.part[k], &byte);
        all |= (byte & ((1U << lanes) - 1U)) << (k * lanes);
    }
    return all;
}
HWY_INLINE bool any(const RowMask& mask) {
    Mask found = mask.part[0];
    for (size_t k = 1; k < vectors; ++k) found = hn::Or(found, mask.part[k]);
    return !hn::AllFalse(Tag(), found);
}
HWY_INLINE RowMask mask_of(uint32_t bits) {
    return each<RowMask>([&](size_t k) HWY_ATTR {
        const uint8_t bytes[8] = {
            static_cast<uint8_t>((bits >> (k * lanes)) & ((1U << lanes) - 1U))};
        return hn::LoadMaskBits(Tag(), bytes);
    });
}

struct Stretch {
    Row lower, upper;
};

HWY_INLINE RowMask overlap(const Stretch& a, const Stretch& b) {
    return below(a.lower, b.upper) & below(b.lower, a.upper);
}

/// The swept segments of a chunk of lines, and for each end the square of the normal's component
/// along the line, 1 if unknown.
struct Swept {
    Stretch ends;
    Row low_facing, high_facing;
};

HWY_INLINE Swept empty_sweep() {
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

/// Positions of lines, seen along them, relative to the path of a capsule.
struct Sideways {
    Row g, beyond; // along the path; w^2
    Row past;      // distance before the start or beyond the end of the path
    RowMask met;
};

HWY_INLINE Sideways sideways(const CapsuleLanes& c, const Row& u, double v) {
    const Row ou = u - c.from_u;
    const double ov = v - c.from_v;
    const Row g = ou * c.cos_u + ov * c.cos_v;
    const Row e = ou * c.cos_v - ov * c.cos_u;
    const Row beyond = (row_of(c.radius) - e) * (e + c.radius);
    const Row past = g - within_move(g * c.per_length) * c.length;
    return {g, beyond, past, at_most(past * past, beyond)};
}

HWY_INLINE Row moment(const CapsuleLanes& c, const Sideways& at, const Row& half, double by_half,
                      double offset) {
    return within_move(at.g * c.per_length + half * by_half + offset);
}

HWY_INLINE void add_ball(const CapsuleLanes& c, const Row& u, double v, Swept& all) {
    const Sideways at = sideways(c, u, v);
    const auto deep = [&](const Row& t) HWY_ATTR {
        const Row past = at.g - t * c.length;
        return root(at.beyond - past * past);
    };
    // At the lowest or highest point of the surface, a small error in time has no effect on the
    // height, unless the move is steep: then the line may even be outside the ball at that time.
    const Row half = c.steep ? root(at.beyond) : rough_root(at.beyond);
    const auto inside = [&](const Row& t) HWY_ATTR {
        if (!c.steep) return t;
        const Row past = at.g - t * c.length;
        return choose(at_most(past * past, at.beyond), t, within_move(at.g * c.per_length));
    };
    const Row t = inside(moment(c, at, half, c.low_by_half, c.low_at));
    const double per_square = 1.0 / (c.radius * c.radius);
    const Row low = deep(t);
    unite_low(all, at.met, t * c.by_a + c.from_a - low, low * low * per_square);
    if (c.opens_up) {
        unite_high(all, at.met, row_of(c.high_end), row_of(1.0));
        return;
    }
    const Row last = inside(moment(c, at, half, c.high_by_half, c.high_at));
    const Row high = deep(last);
    unite_high(all, at.met, last * c.by_a + c.from_a + high, high * high * per_square);
}

HWY_INLINE void add_upright(const CapsuleLanes& c, const Row& u, double v, Swept& all) {
    const Sideways at = sideways(c, u, v);
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

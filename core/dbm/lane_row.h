// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_ROW_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_ROW_H
#undef FEELER_LANE_ROW_H
#else
#define FEELER_LANE_ROW_H
#endif

#include <hwy/highway.h>

#include "core/dbm/scan_lines.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// So many lines are worked on at a time, on every instruction set: half a row of a tile.
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
/// A root good to seven digits, for what need not be exact: half the cost.
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

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#endif

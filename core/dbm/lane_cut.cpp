#include "core/dbm/lane_cut.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/dbm/lane_cut.cpp"
#include <hwy/foreach_target.h> // includes this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t side = ScanTile::side;

using Tag = hn::CappedTag<double, 8>;
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

constexpr size_t lanes = hn::MaxLanes(Tag());
constexpr size_t vectors = side / lanes;

/// A number for each line of a row. Each operation is done for the whole row before the next one,
/// so that none of them waits for the one before.
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

struct Stretch {
    Row lower, upper;
};

HWY_INLINE Stretch no_stretch() { return {row_of(infinity), row_of(-infinity)}; }

HWY_INLINE void unite(Stretch& all, const RowMask& valid, const Row& lower, const Row& upper) {
    all.lower = least(all.lower, choose(valid, lower, row_of(infinity)));
    all.upper = most(all.upper, choose(valid, upper, row_of(-infinity)));
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

HWY_INLINE void add_ball(const CapsuleLanes& c, const Row& u, double v, Stretch& all) {
    const Beside at = beside(c, u, v);
    const auto deep = [&](const Row& t) HWY_ATTR {
        const Row past = at.g - t * c.length;
        return root(at.beyond - past * past);
    };
    // Where the surface is lowest or highest, a little off in time is nothing in height.
    const Row half = rough_root(at.beyond);
    const Row t = moment(c, at, half, c.low_by_half, c.low_at);
    const Row low = t * c.by_a + c.from_a - deep(t);
    if (c.opens_up) {
        unite(all, at.met, low, row_of(c.high_end));
        return;
    }
    const Row last = moment(c, at, half, c.high_by_half, c.high_at);
    unite(all, at.met, low, last * c.by_a + c.from_a + deep(last));
}

HWY_INLINE void add_upright(const CapsuleLanes& c, const Row& u, double v, Stretch& all) {
    const Beside at = beside(c, u, v);
    const Row half = root(at.beyond);
    const Row low = moment(c, at, half, c.low_by_half, c.low_at) * c.by_a + (c.from_a + c.low_end);
    if (c.opens_up) {
        unite(all, at.met, low, row_of(c.high_end));
        return;
    }
    const Row last = moment(c, at, half, c.high_by_half, c.high_at);
    unite(all, at.met, low, last * c.by_a + (c.from_a + c.high_end));
}

/// Narrows the moments first .. last to those at which a point that moves evenly, and stands at
/// `offset` from it, lies within low .. high; `per` is 1 / its way.
HWY_INLINE void narrow(const Row& offset, double low, double high, double per, Row& first,
                       Row& last) {
    const Row one = (offset - low) * per, other = (offset - high) * per;
    first = most(first, least(one, other));
    last = least(last, most(one, other));
}

HWY_INLINE void add_across(const AcrossLanes& c, const Row& u, double v, Stretch& all) {
    const Row s = (c.side_is_u ? u : row_of(v)) - c.from_side;
    const Row z = (c.side_is_u ? row_of(v) : u) - c.from_z;
    Row first = row_of(0.0), last = row_of(1.0);
    RowMask met = at_most(first, last);
    if (c.per_z == 0.0)
        met = at_most(row_of(c.z0 + std::min(0.0, c.by_z)), z)
              & at_most(z, row_of(c.z1 + std::max(0.0, c.by_z)));
    else
        narrow(z, c.z0, c.z1, c.per_z, first, last);
    if (c.per_side == 0.0)
        met = met & at_most(row_of(-c.radius), s) & at_most(s, row_of(c.radius));
    else
        narrow(s, -c.radius, c.radius, c.per_side, first, last);
    met = met & at_most(first, last);
    if (!any(met)) return;
    const auto half = [&](const Row& t) HWY_ATTR {
        const Row aside = s - t * c.by_side;
        return root((row_of(c.radius) - aside) * (aside + c.radius));
    };
    const Row touching = s * c.per_side;
    const Row low = least(most(touching + c.low_at, first), last);
    const Row high = least(most(touching + c.high_at, first), last);
    unite(all, met, low * c.by_a + c.from_a - half(low), high * c.by_a + c.from_a + half(high));
}

/// Line by line, for shapes and moves that have no lanes of their own.
Stretch stretches_one_by_one(const LanePlan& plan, const double* u, double v, uint32_t wanted) {
    RowStretches out;
    for (size_t i = 0; i < side; ++i) {
        const bool asked = (wanted >> i) & 1U;
        const auto found =
            asked ? line_interval(*plan.piece, *plan.sweep, plan.axis, u[i], v) : std::nullopt;
        out.lower[i] = found ? found->lower : infinity;
        out.upper[i] = found ? found->upper : -infinity;
    }
    return {load(out.lower.data()), load(out.upper.data())};
}

/// Ends are put on a lattice of 2.3e-10 mm: two moves that leave the same surface then leave the
/// same bits, and neither cuts a rounding error from the other's.
HWY_INLINE Row on_lattice(const Row& x) {
    constexpr double per_mm = 4294967296.0; // 2^32
    const Row scaled = x * per_mm;
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Round(scaled.part[k]); }) * (1.0 / per_mm);
}

/// What the plan sweeps on a row of lines; those that are not wanted may come out empty.
HWY_INLINE Stretch stretches_of(const LanePlan& plan, const double* u, double v, uint32_t wanted) {
    Stretch all = plan.by_lanes ? no_stretch() : stretches_one_by_one(plan, u, v, wanted);
    const Row at_u = load(u);
    for (size_t i = 0; i < plan.balls; ++i) {
        const CapsuleLanes& c = plan.ball[i];
        if (u[0] <= c.u_most && v <= c.v_most) add_ball(c, at_u, v, all);
    }
    for (size_t i = 0; i < plan.uprights; ++i) add_upright(plan.upright[i], at_u, v, all);
    for (size_t i = 0; i < plan.across; ++i) add_across(plan.level[i], at_u, v, all);
    return {on_lattice(all.lower), on_lattice(all.upper)};
}

HWY_ATTR void stretches(const LanePlan& plan, const double* u, double v, uint32_t wanted,
                        RowStretches& out) {
    const Stretch found = stretches_of(plan, u, v, wanted);
    store(found.lower, out.lower.data());
    store(found.upper, out.upper.data());
}

HWY_ATTR void shared(const RowStretches& front, const RowStretches& back, const Interval& front_end,
                     const Interval& back_end, double less, RowStretches& out) {
    // One corner farther on, with the end of the row in the last place.
    const auto next = [](const std::array<double, side>& row, double end) HWY_ATTR {
        std::array<double, side> moved;
        std::copy(row.begin() + 1, row.end(), moved.begin());
        moved.back() = end;
        return load(moved.data());
    };
    const Row lower = most(most(load(front.lower.data()), next(front.lower, front_end.lower)),
                           most(load(back.lower.data()), next(back.lower, back_end.lower)))
                      + less;
    const Row upper = least(least(load(front.upper.data()), next(front.upper, front_end.upper)),
                            least(load(back.upper.data()), next(back.upper, back_end.upper)))
                      - less;
    const RowMask some = below(lower, upper);
    store(choose(some, lower, row_of(infinity)), out.lower.data());
    store(choose(some, upper, row_of(-infinity)), out.upper.data());
}

/// Layer k of a row.
HWY_INLINE Stretch matter_of(const ScanTile& tile, size_t k, size_t place) {
    return {load(&tile.layers[k].lower[place]), load(&tile.layers[k].upper[place])};
}

HWY_INLINE RowMask overlap(const Stretch& a, const Stretch& b) {
    return below(a.lower, b.upper) & below(b.lower, a.upper);
}

/// The layers, by bit, that hold matter on any of the lines within a stretch; all beyond the 32nd
/// count as one.
HWY_INLINE uint32_t layers_with_matter(const ScanTile& tile, size_t place, const Stretch& where,
                                       const RowMask& wanted) {
    uint32_t layers = 0;
    for (size_t k = 0; k < tile.layers.size(); ++k)
        if (any(overlap(matter_of(tile, k, place), where) & wanted))
            layers |= 1U << std::min(k, size_t{31});
    return layers;
}

/// Runs `act` over the layers of a mask.
template <typename Act>
HWY_INLINE void for_layers(const ScanTile& tile, uint32_t layers, const Act& act) {
    for (uint32_t left = layers & 0x7fffffffU; left != 0; left &= left - 1)
        act(static_cast<size_t>(std::countr_zero(left)));
    if (layers >> 31U)
        for (size_t k = 31; k < tile.layers.size(); ++k) act(k);
}

HWY_INLINE uint32_t lines_overlapping(const ScanTile& tile, size_t place, const Stretch& where) {
    uint32_t found = 0;
    for (size_t k = 0; k < tile.layers.size(); ++k)
        found |= bits_of(overlap(matter_of(tile, k, place), where));
    return found;
}

/// How many of the grid's coordinates along Z lie below x, or up to x.
HWY_INLINE Row points_below(const ScanGrid& grid, const Row& x, bool itself) {
    const double half = grid.half_count[2];
    // Half way between two points either of them serves.
    const Row near = (x - grid.centre.z) * (1.0 / grid.spacing) + (half - 0.5);
    const Row index = each<Row>([&](size_t k) HWY_ATTR { return hn::Round(near.part[k]); });
    const Row there = row_of(grid.centre.z) + (index - half + 0.5) * grid.spacing;
    const RowMask counts = itself ? at_most(there, x) : below(there, x);
    return index + choose(counts, row_of(1.0), row_of(0.0));
}

HWY_INLINE Row points_between(const ScanGrid& grid, const Stretch& s) {
    return most(points_below(grid, s.upper, false) - points_below(grid, s.lower, true),
                row_of(0.0));
}

HWY_INLINE void add_to(std::array<double, side>& sums, const RowMask& where, const Row& what) {
    store(load(sums.data()) + choose(where, what, row_of(0.0)), sums.data());
}

HWY_INLINE void set_marks(uint32_t* marks, uint32_t which, uint32_t mark) {
    const hn::CappedTag<uint32_t, side> d;
    for (size_t i = 0; i < side; i += hn::Lanes(d)) {
        const uint32_t here = which >> i;
        const uint8_t bytes[8] = {static_cast<uint8_t>(here), static_cast<uint8_t>(here >> 8U)};
        const auto chosen = hn::LoadMaskBits(d, bytes);
        hn::Store(hn::IfThenElse(chosen, hn::Set(d, mark), hn::Load(d, marks + i)), d, marks + i);
    }
}

/// Shortens the intervals of a layer; those in `wanted` keep one end, or go.
HWY_INLINE void trim(const TileTask& task, ScanTile& tile, size_t k, size_t place,
                     const Stretch& gone, const RowMask& wanted, TileCut& done) {
    const Stretch old = matter_of(tile, k, place);
    const RowMask from_below = wanted & at_most(gone.lower, old.lower);
    const RowMask from_above = wanted & at_most(old.upper, gone.upper);
    const RowMask whole = from_below & from_above;
    const Stretch now{choose(whole, row_of(infinity), choose(from_below, gone.upper, old.lower)),
                      choose(whole, row_of(-infinity), choose(from_above, gone.lower, old.upper))};
    store(now.lower, &tile.layers[k].lower[place]);
    store(now.upper, &tile.layers[k].upper[place]);
    add_to(done.length, wanted, least(old.upper, gone.upper) - most(old.lower, gone.lower));
    if (task.count_points != nullptr) {
        const Row left = choose(whole, row_of(0.0), points_between(*task.count_points, now));
        add_to(done.points, wanted, points_between(*task.count_points, old) - left);
    }
    if (tile.marks.empty()) return;
    if (any(from_below)) set_marks(&tile.marks[k].lower[place], bits_of(from_below), task.mark);
    if (any(from_above)) set_marks(&tile.marks[k].upper[place], bits_of(from_above), task.mark);
}

void note_blocks(TileCut& done, size_t place, uint32_t changed) {
    const size_t row = place / side;
    for (uint32_t group = 0; changed != 0; changed >>= 4U, ++group)
        if ((changed & 15U) != 0) done.blocks |= 1U << (row / 4 * 4 + group);
}

void note_by_hand(TileCut& done, size_t place, uint32_t hard, const Stretch& gone) {
    RowStretches out;
    store(gone.lower, out.lower.data());
    store(gone.upper, out.upper.data());
    for (; hard != 0; hard &= hard - 1) {
        const auto i = static_cast<size_t>(std::countr_zero(hard));
        done.by_hand[done.by_hand_count++] = {static_cast<uint32_t>(place + i), out.lower[i],
                                              out.upper[i]};
    }
}

/// Takes stretches out of a row of lines, where the layers hold matter.
HWY_INLINE void take_row(const TileTask& task, ScanTile& tile, size_t place, uint32_t layers,
                         const Stretch& gone, TileCut& done) {
    RowMask hard = below(row_of(1.0), row_of(0.0));
    RowMask met = hard;
    const bool many = tile.layers.size() > 1;
    for_layers(tile, layers, [&](size_t k) HWY_ATTR {
        const Stretch old = matter_of(tile, k, place);
        const RowMask over = overlap(old, gone);
        const RowMask from_below = at_most(gone.lower, old.lower);
        const RowMask from_above = at_most(old.upper, gone.upper);
        met = met | over;
        hard = hard | but_not(over, from_below | from_above);
        if (many) hard = hard | (over & from_below & from_above);
    });
    if (!any(met)) return;
    for_layers(tile, layers, [&](size_t k) HWY_ATTR {
        const RowMask wanted = but_not(overlap(matter_of(tile, k, place), gone), hard);
        if (any(wanted)) trim(task, tile, k, place, gone, wanted, done);
    });
    if (any(hard)) note_by_hand(done, place, bits_of(hard), gone);
    note_blocks(done, place, bits_of(met));
}

/// Runs `act` over the rows that hold matter where the task looks for it.
template <typename Act>
HWY_INLINE void for_rows_with_matter(const TileTask& task, const ScanTile& tile, const Act& act) {
    const Stretch looked_at{row_of(task.low), row_of(task.high)};
    const RowMask wanted = mask_of(task.lanes);
    for (int row = task.row_first; row < task.row_last; ++row) {
        const size_t place = static_cast<size_t>(row) * side;
        const uint32_t layers = layers_with_matter(tile, place, looked_at, wanted);
        if (layers != 0) act(row, place, layers);
    }
}

HWY_ATTR bool changes(const LanePlan& plan, const TileTask& task, const ScanTile& tile) {
    bool found = false;
    for_rows_with_matter(task, tile, [&](int row, size_t place, uint32_t) HWY_ATTR {
        if (found) return;
        const double v = task.v[static_cast<size_t>(row)];
        found = lines_overlapping(tile, place, stretches_of(plan, task.u, v, task.lanes)) != 0;
    });
    return found;
}

HWY_ATTR void cut(const LanePlan& plan, const TileTask& task, ScanTile& tile, TileCut& done) {
    for_rows_with_matter(task, tile, [&](int row, size_t place, uint32_t layers) HWY_ATTR {
        const double v = task.v[static_cast<size_t>(row)];
        take_row(task, tile, place, layers, stretches_of(plan, task.u, v, task.lanes), done);
    });
}

HWY_ATTR uint32_t lines_with_matter(const ScanTile& tile, int row, double low, double high) {
    return lines_overlapping(tile, static_cast<size_t>(row) * side, {row_of(low), row_of(high)});
}

HWY_ATTR uint32_t lines_met(const ScanTile& tile, int row, const RowStretches& gone) {
    return lines_overlapping(tile, static_cast<size_t>(row) * side,
                             {load(gone.lower.data()), load(gone.upper.data())});
}

HWY_ATTR void take(const TileTask& task, int row, const RowStretches& gone, ScanTile& tile,
                   TileCut& done) {
    const size_t place = static_cast<size_t>(row) * side;
    const Stretch here{load(gone.lower.data()), load(gone.upper.data())};
    const uint32_t layers = layers_with_matter(tile, place, here, mask_of(0xffff));
    if (layers != 0) take_row(task, tile, place, layers, here, done);
}

const LaneCut* loops() {
    static constexpr LaneCut table = {stretches,         shared,    changes, cut,
                                      lines_with_matter, lines_met, take};
    return &table;
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace core {
namespace {
HWY_EXPORT(loops);
} // namespace

const LaneCut& lane_cut() { return *HWY_DYNAMIC_DISPATCH(loops)(); }

} // namespace core
#endif

#include "core/dbm/lane_cut.h"

#include <bit>
#include <cstring>

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

struct Stretch {
    Vec lower, upper;
};

HWY_INLINE uint32_t bits_of(Mask mask) {
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(Tag(), mask, bytes);
    uint32_t bits = 0;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
}

HWY_INLINE Vec set(double x) { return hn::Set(Tag(), x); }
HWY_INLINE Vec within_move(Vec t) { return hn::Min(hn::Max(t, hn::Zero(Tag())), set(1.0)); }
HWY_INLINE Vec root(Vec x) { return hn::Sqrt(hn::Max(x, hn::Zero(Tag()))); }

HWY_INLINE void unite(Stretch& all, Mask valid, Vec lower, Vec upper) {
    all.lower = hn::Min(all.lower, hn::IfThenElse(valid, lower, set(infinity)));
    all.upper = hn::Max(all.upper, hn::IfThenElse(valid, upper, set(-infinity)));
}

/// Where lines lie, seen along them, from the path of a capsule.
struct Beside {
    Vec g, beyond, half; // along the path; w^2; w
    Mask met;
};

HWY_INLINE Beside beside(const CapsuleLanes& c, Vec u, Vec v) {
    const Vec ou = hn::Sub(u, set(c.from_u)), ov = hn::Sub(v, set(c.from_v));
    const Vec g = hn::Add(hn::Mul(ou, set(c.cos_u)), hn::Mul(ov, set(c.cos_v)));
    const Vec e = hn::Sub(hn::Mul(ou, set(c.cos_v)), hn::Mul(ov, set(c.cos_u)));
    const Vec r = set(c.radius);
    const Vec beyond = hn::Mul(hn::Sub(r, e), hn::Add(r, e));
    const Vec foot = within_move(hn::Mul(g, set(c.per_length)));
    const Vec past = hn::Sub(g, hn::Mul(foot, set(c.length)));
    return {g, beyond, root(beyond), hn::Ge(beyond, hn::Mul(past, past))};
}

HWY_INLINE Vec moment(const CapsuleLanes& c, const Beside& at, double by_half, double offset) {
    const Vec touching = hn::Add(hn::Mul(at.g, set(c.per_length)), hn::Mul(at.half, set(by_half)));
    return within_move(hn::Add(touching, set(offset)));
}

HWY_INLINE void add_ball(const CapsuleLanes& c, Vec u, Vec v, Stretch& all) {
    const Beside at = beside(c, u, v);
    if (hn::AllFalse(Tag(), at.met)) return;
    const auto end = [&](double by_half, double offset, double sign) HWY_ATTR {
        const Vec t = moment(c, at, by_half, offset);
        const Vec past = hn::Sub(at.g, hn::Mul(t, set(c.length)));
        const Vec deep = root(hn::Sub(at.beyond, hn::Mul(past, past)));
        const Vec centre = hn::Add(set(c.from_a), hn::Mul(t, set(c.by_a)));
        return hn::Add(centre, hn::Mul(set(sign), deep));
    };
    unite(all, at.met, end(c.low_by_half, c.low_at, -1.0), end(c.high_by_half, c.high_at, 1.0));
}

HWY_INLINE void add_upright(const CapsuleLanes& c, Vec u, Vec v, Stretch& all) {
    const Beside at = beside(c, u, v);
    if (hn::AllFalse(Tag(), at.met)) return;
    const Vec low = hn::Mul(moment(c, at, c.low_by_half, c.low_at), set(c.by_a));
    const Vec high = hn::Mul(moment(c, at, c.high_by_half, c.high_at), set(c.by_a));
    unite(all, at.met, hn::Add(set(c.from_a + c.low_end), low),
          hn::Add(set(c.from_a + c.high_end), high));
}

HWY_INLINE void add_across(const AcrossLanes& c, Vec u, Vec v, Stretch& all) {
    const Vec s = hn::Sub(c.side_is_u ? u : v, set(c.from_side));
    const Vec z = hn::Sub(c.side_is_u ? v : u, set(c.from_z));
    const Vec zero = hn::Zero(Tag()), r = set(c.radius);
    Vec first = zero, last = set(1.0);
    Mask met = hn::Le(zero, last);
    if (c.per_z == 0.0) {
        const Vec least = set(c.z0 + std::min(0.0, c.by_z));
        const Vec most = set(c.z1 + std::max(0.0, c.by_z));
        met = hn::And(hn::Le(least, z), hn::Le(z, most));
    } else {
        const Vec one = hn::Mul(hn::Sub(z, set(c.z0)), set(c.per_z));
        const Vec other = hn::Mul(hn::Sub(z, set(c.z1)), set(c.per_z));
        first = hn::Max(first, hn::Min(one, other));
        last = hn::Min(last, hn::Max(one, other));
    }
    if (c.per_side == 0.0) {
        met = hn::And(met, hn::Le(hn::Abs(s), r));
    } else {
        const Vec one = hn::Mul(hn::Sub(s, r), set(c.per_side));
        const Vec other = hn::Mul(hn::Add(s, r), set(c.per_side));
        first = hn::Max(first, hn::Min(one, other));
        last = hn::Min(last, hn::Max(one, other));
    }
    met = hn::And(met, hn::Le(first, last));
    if (hn::AllFalse(Tag(), met)) return;
    const auto end = [&](double offset, double sign) HWY_ATTR {
        const Vec touching = hn::Add(hn::Mul(s, set(c.per_side)), set(offset));
        const Vec t = hn::Min(hn::Max(touching, first), last);
        const Vec aside = hn::Sub(s, hn::Mul(t, set(c.by_side)));
        const Vec half = root(hn::Mul(hn::Sub(r, aside), hn::Add(r, aside)));
        const Vec centre = hn::Add(set(c.from_a), hn::Mul(t, set(c.by_a)));
        return hn::Add(centre, hn::Mul(set(sign), half));
    };
    unite(all, met, end(c.low_at, -1.0), end(c.high_at, 1.0));
}

/// Line by line, for shapes and moves that have no lanes of their own.
Stretch stretches_one_by_one(const LanePlan& plan, const double* u, double v) {
    alignas(64) std::array<double, 8> lower, upper;
    for (size_t i = 0; i < hn::Lanes(Tag()); ++i) {
        const auto found = line_interval(*plan.piece, *plan.sweep, plan.axis, u[i], v);
        lower[i] = found ? found->lower : infinity;
        upper[i] = found ? found->upper : -infinity;
    }
    return {hn::Load(Tag(), lower.data()), hn::Load(Tag(), upper.data())};
}

/// What the plan sweeps on as many lines as there are lanes.
HWY_INLINE Stretch stretches_of(const LanePlan& plan, const double* u, double v) {
    if (!plan.by_lanes) return stretches_one_by_one(plan, u, v);
    Stretch all{set(infinity), set(-infinity)};
    const Vec at_u = hn::LoadU(Tag(), u), at_v = set(v);
    for (size_t i = 0; i < plan.balls; ++i) {
        const CapsuleLanes& c = plan.ball[i];
        if (u[0] <= c.u_most && v <= c.v_most) add_ball(c, at_u, at_v, all);
    }
    for (size_t i = 0; i < plan.uprights; ++i) add_upright(plan.upright[i], at_u, at_v, all);
    for (size_t i = 0; i < plan.across; ++i) add_across(plan.level[i], at_u, at_v, all);
    return all;
}

HWY_ATTR void stretches(const LanePlan& plan, const double* u, double v, RowStretches& out) {
    for (size_t i = 0; i < side; i += hn::Lanes(Tag())) {
        const Stretch found = stretches_of(plan, u + i, v);
        hn::Store(found.lower, Tag(), &out.lower[i]);
        hn::Store(found.upper, Tag(), &out.upper[i]);
    }
}

HWY_ATTR void corners(const LanePlan& plan, const double* u, double v, uint32_t wanted,
                      CornerStretches& out) {
    constexpr size_t step = hn::MaxLanes(Tag());
    for (size_t i = 0; i <= side; i += step) {
        const bool any = ((wanted >> i) & ((1U << step) - 1U)) != 0;
        const Stretch found =
            any ? stretches_of(plan, u + i, v) : Stretch{set(infinity), set(-infinity)};
        hn::Store(found.lower, Tag(), &out.lower[i]);
        hn::Store(found.upper, Tag(), &out.upper[i]);
    }
}

HWY_ATTR void shared(const CornerStretches& front, const CornerStretches& back, double less,
                     RowStretches& out) {
    const Tag d;
    for (size_t i = 0; i < side; i += hn::Lanes(d)) {
        const auto all = [&](const auto& f, const auto& b, const auto& join) HWY_ATTR {
            return join(join(hn::Load(d, &f[i]), hn::LoadU(d, &f[i + 1])),
                        join(hn::Load(d, &b[i]), hn::LoadU(d, &b[i + 1])));
        };
        const Vec lower = hn::Add(
            all(front.lower, back.lower, [](Vec a, Vec b) HWY_ATTR { return hn::Max(a, b); }),
            set(less));
        const Vec upper = hn::Sub(
            all(front.upper, back.upper, [](Vec a, Vec b) HWY_ATTR { return hn::Min(a, b); }),
            set(less));
        const Mask some = hn::Lt(lower, upper);
        hn::Store(hn::IfThenElse(some, lower, set(infinity)), d, &out.lower[i]);
        hn::Store(hn::IfThenElse(some, upper, set(-infinity)), d, &out.upper[i]);
    }
}

HWY_INLINE Mask overlap(const ScanTile::Layer& layer, size_t place, const Stretch& gone) {
    return hn::And(hn::Lt(hn::Load(Tag(), &layer.lower[place]), gone.upper),
                   hn::Gt(hn::Load(Tag(), &layer.upper[place]), gone.lower));
}

HWY_INLINE Mask overlap_of_any(const ScanTile& tile, size_t place, const Stretch& gone) {
    Mask met = overlap(tile.layers[0], place, gone);
    for (size_t k = 1; k < tile.layers.size(); ++k)
        met = hn::Or(met, overlap(tile.layers[k], place, gone));
    return met;
}

/// How many of the grid's coordinates along Z lie below x, or up to x.
HWY_INLINE Vec points_below(const ScanGrid& grid, Vec x, bool itself) {
    const Vec half = set(grid.half_count[2]), h = set(grid.spacing), centre = set(grid.centre.z);
    const Vec index = hn::Round(hn::Add(hn::Div(hn::Sub(x, centre), h), hn::Sub(half, set(0.5))));
    const Vec there = hn::Add(centre, hn::Mul(hn::Add(hn::Sub(index, half), set(0.5)), h));
    const Mask counts = itself ? hn::Le(there, x) : hn::Lt(there, x);
    return hn::Add(index, hn::IfThenElseZero(counts, set(1.0)));
}

HWY_INLINE Vec points_between(const ScanGrid& grid, Vec lower, Vec upper) {
    return hn::Max(hn::Sub(points_below(grid, upper, false), points_below(grid, lower, true)),
                   hn::Zero(Tag()));
}

HWY_INLINE void add_to(double* sums, Mask where, Vec what) {
    hn::Store(hn::Add(hn::Load(Tag(), sums), hn::IfThenElseZero(where, what)), Tag(), sums);
}

void set_marks(ScanTile::Marks& marks, size_t place, uint32_t lower, uint32_t upper,
               uint32_t mark) {
    for (; lower != 0; lower &= lower - 1)
        marks.lower[place + static_cast<size_t>(std::countr_zero(lower))] = mark;
    for (; upper != 0; upper &= upper - 1)
        marks.upper[place + static_cast<size_t>(std::countr_zero(upper))] = mark;
}

/// Shortens the intervals of a layer; those in `wanted` keep one end, or go.
HWY_INLINE void trim(const TileTask& task, ScanTile& tile, size_t k, size_t place,
                     const Stretch& gone, Mask wanted, TileCut& done) {
    ScanTile::Layer& layer = tile.layers[k];
    const Vec lower = hn::Load(Tag(), &layer.lower[place]);
    const Vec upper = hn::Load(Tag(), &layer.upper[place]);
    const Mask from_below = hn::And(wanted, hn::Le(gone.lower, lower));
    const Mask from_above = hn::And(wanted, hn::Ge(gone.upper, upper));
    const Mask whole = hn::And(from_below, from_above);
    const Vec new_lower =
        hn::IfThenElse(whole, set(infinity), hn::IfThenElse(from_below, gone.upper, lower));
    const Vec new_upper =
        hn::IfThenElse(whole, set(-infinity), hn::IfThenElse(from_above, gone.lower, upper));
    hn::Store(new_lower, Tag(), &layer.lower[place]);
    hn::Store(new_upper, Tag(), &layer.upper[place]);
    const size_t lane = place % side;
    add_to(&done.length[lane], wanted,
           hn::Sub(hn::Min(upper, gone.upper), hn::Max(lower, gone.lower)));
    if (task.count_points != nullptr) {
        const Vec before = points_between(*task.count_points, lower, upper);
        const Vec after = hn::IfThenElseZero(
            hn::Lt(new_lower, new_upper), points_between(*task.count_points, new_lower, new_upper));
        add_to(&done.points[lane], wanted, hn::Sub(before, after));
    }
    if (!tile.marks.empty())
        set_marks(tile.marks[k], place, bits_of(from_below), bits_of(from_above), task.mark);
}

void note_blocks(TileCut& done, size_t place, uint32_t lanes) {
    const size_t row = place / side, first = place % side;
    for (uint32_t all = lanes << first, group = 0; all != 0; all >>= 4U, ++group)
        if ((all & 15U) != 0) done.blocks |= 1U << (row / 4 * 4 + group);
}

HWY_INLINE void note_by_hand(TileCut& done, size_t place, Mask hard, const Stretch& gone) {
    alignas(64) std::array<double, 8> lower, upper;
    hn::Store(gone.lower, Tag(), lower.data());
    hn::Store(gone.upper, Tag(), upper.data());
    for (uint32_t lanes = bits_of(hard); lanes != 0; lanes &= lanes - 1) {
        const auto i = static_cast<size_t>(std::countr_zero(lanes));
        done.by_hand[done.by_hand_count++] = {static_cast<uint32_t>(place + i), lower[i], upper[i]};
    }
}

/// Takes stretches out of as many lines as there are lanes.
HWY_INLINE void take_lanes(const TileTask& task, ScanTile& tile, size_t place, const Stretch& gone,
                           TileCut& done) {
    const Mask met = overlap_of_any(tile, place, gone);
    if (hn::AllFalse(Tag(), met)) return;
    Mask hard = hn::Lt(set(1.0), hn::Zero(Tag()));
    const bool many = tile.layers.size() > 1;
    for (const ScanTile::Layer& layer : tile.layers) {
        const Mask over = overlap(layer, place, gone);
        const Mask below = hn::Le(gone.lower, hn::Load(Tag(), &layer.lower[place]));
        const Mask above = hn::Ge(gone.upper, hn::Load(Tag(), &layer.upper[place]));
        const Mask divided = hn::AndNot(hn::Or(below, above), over);
        hard = hn::Or(hard, many ? hn::Or(divided, hn::And(over, hn::And(below, above))) : divided);
    }
    for (size_t k = 0; k < tile.layers.size(); ++k) {
        const Mask wanted = hn::AndNot(hard, overlap(tile.layers[k], place, gone));
        if (!hn::AllFalse(Tag(), wanted)) trim(task, tile, k, place, gone, wanted, done);
    }
    if (!hn::AllFalse(Tag(), hard)) note_by_hand(done, place, hard, gone);
    note_blocks(done, place, bits_of(met));
}

/// Runs `act` over the groups of lanes that hold matter where the task looks for it.
template <typename Act>
HWY_INLINE void for_lanes_with_matter(const TileTask& task, const ScanTile& tile, const Act& act) {
    constexpr size_t step = hn::MaxLanes(Tag());
    constexpr uint32_t all_lanes = (1U << step) - 1U;
    const Stretch looked_at{set(task.low), set(task.high)};
    for (int row = task.row_first; row < task.row_last; ++row)
        for (size_t i = 0; i < side; i += step) {
            if (((task.lanes >> i) & all_lanes) == 0) continue;
            const size_t place = static_cast<size_t>(row) * side + i;
            const Mask met = overlap_of_any(tile, place, looked_at);
            if (!hn::AllFalse(Tag(), met)) act(row, i, place);
        }
}

HWY_ATTR bool changes(const LanePlan& plan, const TileTask& task, const ScanTile& tile) {
    bool any = false;
    for_lanes_with_matter(task, tile, [&](int row, size_t i, size_t place) HWY_ATTR {
        if (any) return;
        const Stretch gone = stretches_of(plan, &task.u[i], task.v[static_cast<size_t>(row)]);
        any = !hn::AllFalse(Tag(), overlap_of_any(tile, place, gone));
    });
    return any;
}

HWY_ATTR void cut(const LanePlan& plan, const TileTask& task, ScanTile& tile, TileCut& done) {
    for_lanes_with_matter(task, tile, [&](int row, size_t i, size_t place) HWY_ATTR {
        take_lanes(task, tile, place,
                   stretches_of(plan, &task.u[i], task.v[static_cast<size_t>(row)]), done);
    });
}

HWY_ATTR uint32_t lines_met(const ScanTile& tile, int row, const RowStretches& gone) {
    uint32_t lanes = 0;
    for (size_t i = 0; i < side; i += hn::Lanes(Tag())) {
        const Stretch here{hn::Load(Tag(), &gone.lower[i]), hn::Load(Tag(), &gone.upper[i])};
        lanes |= bits_of(overlap_of_any(tile, static_cast<size_t>(row) * side + i, here)) << i;
    }
    return lanes;
}

HWY_ATTR uint32_t lines_with_matter(const ScanTile& tile, int row, double low, double high) {
    uint32_t lanes = 0;
    const Stretch looked_at{set(low), set(high)};
    for (size_t i = 0; i < side; i += hn::Lanes(Tag()))
        lanes |= bits_of(overlap_of_any(tile, static_cast<size_t>(row) * side + i, looked_at)) << i;
    return lanes;
}

HWY_ATTR void take(const TileTask& task, int row, const RowStretches& gone, ScanTile& tile,
                   TileCut& done) {
    for (size_t i = 0; i < side; i += hn::Lanes(Tag()))
        take_lanes(task, tile, static_cast<size_t>(row) * side + i,
                   {hn::Load(Tag(), &gone.lower[i]), hn::Load(Tag(), &gone.upper[i])}, done);
}

const LaneCut* loops() {
    static constexpr LaneCut table = {stretches, corners,           shared,    changes,
                                      cut,       lines_with_matter, lines_met, take};
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

#include "core/dbm/lane_cut.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/dbm/lane_cut.cpp"
#include <hwy/foreach_target.h> // includes this file once for each instruction set
#include <hwy/highway.h>

#include "core/dbm/lane_stretch.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {
HWY_ATTR void stretches(const LanePlan& plan, const double* u, double v, uint32_t wanted,
                        RowStretches& out) {
    const Stretch found = swept_of(plan, u, v, wanted).ends;
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

/// An end of matter as volume counts it: how many of the grid's coordinates lie below, and how far
/// it is above the border half way to the next one.
struct Counted {
    Row points, beyond;
};

/// Of coordinates that lie on an end, an upper one leaves them out and a lower one, too.
HWY_INLINE Counted counted(const TileTask& task, const Row& x, const RowMask& is_upper) {
    const ScanGrid& grid = *task.grid;
    const double half = grid.half_count[static_cast<size_t>(task.axis)];
    const double centre = grid.centre[task.axis];
    // Half way between two points either of them serves.
    const Row near = (x - centre) * (1.0 / grid.spacing) + (half - 0.5);
    const Row index = each<Row>([&](size_t k) HWY_ATTR { return hn::Round(near.part[k]); });
    const Row there = row_of(centre) + (index - half + 0.5) * grid.spacing;
    const RowMask counts = below(there, x) | but_not(at_most(there, x), is_upper);
    const Row points = index + choose(counts, row_of(1.0), row_of(0.0));
    return {points, x - (row_of(centre) + (points - half) * grid.spacing)};
}

/// What an end weighs, from how it is kept and back.
HWY_INLINE Row facing_of(const uint8_t* tilts) {
    const Row tilt = each<Row>([&](size_t k) HWY_ATTR {
        const hn::Rebind<uint8_t, Tag> bytes;
        const hn::Rebind<int32_t, Tag> words;
        return hn::PromoteTo(Tag(), hn::PromoteTo(words, hn::LoadU(bytes, tilts + k * lanes)));
    });
    return row_of(1.0) - tilt * (1.0 / ScanTile::steepest);
}
HWY_INLINE Row tilt_of(const Row& facing) {
    const Row tilt = (row_of(1.0) - facing) * static_cast<double>(ScanTile::steepest);
    return each<Row>([&](size_t k) HWY_ATTR { return hn::Round(tilt.part[k]); });
}
HWY_INLINE void keep_tilts(uint8_t* tilts, const RowMask& which, const Row& tilt) {
    for (size_t k = 0; k < vectors; ++k) {
        const hn::Rebind<uint8_t, Tag> bytes;
        const hn::Rebind<int32_t, Tag> words;
        const Vec old =
            hn::PromoteTo(Tag(), hn::PromoteTo(words, hn::LoadU(bytes, tilts + k * lanes)));
        const Vec now = hn::IfThenElse(which.part[k], tilt.part[k], old);
        hn::StoreU(hn::DemoteTo(bytes, hn::DemoteTo(words, now)), bytes, tilts + k * lanes);
    }
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

/// Counts what goes when the intervals of a layer are shortened.
HWY_INLINE void count(const TileTask& task, const ScanTile::Marks& marks, size_t place,
                      const Stretch& old, const Swept& gone, const RowMask& wanted,
                      const RowMask& from_below, const RowMask& from_above, TileCut& done) {
    const Row low = row_of(1.0) - tilt_of(gone.low_facing) * (1.0 / ScanTile::steepest);
    const Row high = row_of(1.0) - tilt_of(gone.high_facing) * (1.0 / ScanTile::steepest);
    // What goes ends above at an old upper end or where a new lower one is made, below likewise.
    const Counted upper = counted(task, choose(from_above, old.upper, gone.ends.upper), from_above);
    const Counted lower =
        counted(task, choose(from_below, old.lower, gone.ends.lower), but_not(wanted, from_below));
    const Row upper_facing = choose(from_above, facing_of(&marks.upper_tilt[place]), high);
    const Row lower_facing = choose(from_below, facing_of(&marks.lower_tilt[place]), low);
    add_to(done.beyond, wanted, upper.beyond * upper_facing - lower.beyond * lower_facing);
    if (task.axis == 2) add_to(done.points, wanted, upper.points - lower.points);
}

/// Shortens the intervals of a layer; those in `wanted` keep one end, or go.
HWY_INLINE void trim(const TileTask& task, ScanTile& tile, size_t k, size_t place,
                     const Swept& gone, const RowMask& wanted, TileCut& done) {
    const Stretch old = matter_of(tile, k, place);
    const RowMask from_below = wanted & at_most(gone.ends.lower, old.lower);
    const RowMask from_above = wanted & at_most(old.upper, gone.ends.upper);
    const RowMask whole = from_below & from_above;
    store(choose(whole, row_of(infinity), choose(from_below, gone.ends.upper, old.lower)),
          &tile.layers[k].lower[place]);
    store(choose(whole, row_of(-infinity), choose(from_above, gone.ends.lower, old.upper)),
          &tile.layers[k].upper[place]);
    if (tile.marks.empty()) return;
    ScanTile::Marks& marks = tile.marks[k];
    count(task, marks, place, old, gone, wanted, from_below, from_above, done);
    if (any(from_below)) {
        set_marks(&marks.lower[place], bits_of(from_below), task.mark);
        keep_tilts(&marks.lower_tilt[place], from_below, tilt_of(gone.high_facing));
    }
    if (any(from_above)) {
        set_marks(&marks.upper[place], bits_of(from_above), task.mark);
        keep_tilts(&marks.upper_tilt[place], from_above, tilt_of(gone.low_facing));
    }
}

void note_blocks(TileCut& done, size_t place, uint32_t changed) {
    const size_t row = place / side;
    for (uint32_t group = 0; changed != 0; changed >>= 4U, ++group)
        if ((changed & 15U) != 0) done.blocks |= 1U << (row / 4 * 4 + group);
}

void note_by_hand(TileCut& done, size_t place, uint32_t hard, const Swept& gone) {
    RowStretches out, tilts;
    store(gone.ends.lower, out.lower.data());
    store(gone.ends.upper, out.upper.data());
    store(tilt_of(gone.low_facing), tilts.lower.data());
    store(tilt_of(gone.high_facing), tilts.upper.data());
    for (; hard != 0; hard &= hard - 1) {
        const auto i = static_cast<size_t>(std::countr_zero(hard));
        done.by_hand[done.by_hand_count++] = {static_cast<uint32_t>(place + i),
                                              {out.lower[i], out.upper[i]},
                                              static_cast<uint8_t>(tilts.lower[i]),
                                              static_cast<uint8_t>(tilts.upper[i])};
    }
}

/// Takes stretches out of a row of lines, where the layers hold matter.
HWY_INLINE void take_row(const TileTask& task, ScanTile& tile, size_t place, uint32_t layers,
                         const Swept& gone, TileCut& done) {
    RowMask hard = below(row_of(1.0), row_of(0.0));
    RowMask met = hard;
    const bool many = tile.layers.size() > 1;
    for_layers(tile, layers, [&](size_t k) HWY_ATTR {
        const Stretch old = matter_of(tile, k, place);
        const RowMask over = overlap(old, gone.ends);
        const RowMask from_below = at_most(gone.ends.lower, old.lower);
        const RowMask from_above = at_most(old.upper, gone.ends.upper);
        met = met | over;
        hard = hard | but_not(over, from_below | from_above);
        if (many) hard = hard | (over & from_below & from_above);
    });
    if (!any(met)) return;
    for_layers(tile, layers, [&](size_t k) HWY_ATTR {
        const RowMask wanted = but_not(overlap(matter_of(tile, k, place), gone.ends), hard);
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
        found = lines_overlapping(tile, place, swept_of(plan, task.u, v, task.lanes).ends) != 0;
    });
    return found;
}

HWY_ATTR void cut(const LanePlan& plan, const TileTask& task, ScanTile& tile, TileCut& done) {
    for_rows_with_matter(task, tile, [&](int row, size_t place, uint32_t layers) HWY_ATTR {
        const double v = task.v[static_cast<size_t>(row)];
        take_row(task, tile, place, layers, swept_of(plan, task.u, v, task.lanes), done);
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
    if (layers != 0) take_row(task, tile, place, layers, {here, row_of(1.0), row_of(1.0)}, done);
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

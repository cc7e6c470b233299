#include "core/dbm/lane_cut.h"

#include <algorithm>
#include <bit>
#include <cmath>

// Targets between SSE2, which every x86-64 has, and AVX2 do not speed up these loops.
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/dbm/lane_cut.cpp"
#include <hwy/foreach_target.h> // includes this file once for each instruction set
#include <hwy/highway.h>

#include "core/dbm/lane_row.h"
#include "core/dbm/lane_sweep.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {
HWY_ATTR void stretches(const LanePlan& plan, const double* u, double v, uint32_t wanted,
                        CornerStretches& out) {
    for (size_t first = 0; first < CornerStretches::size; first += chunk, wanted >>= chunk) {
        if ((wanted & 0xffU) == 0) continue;
        const Stretch found = swept_of(plan, u + first, v, wanted).ends;
        store(found.lower, &out.lower[first]);
        store(found.upper, &out.upper[first]);
    }
}

/// Layer k of a row.
HWY_INLINE Stretch matter_of(const ScanTile& tile, size_t k, size_t slot) {
    return {load(&tile.layers[k].lower[slot]), load(&tile.layers[k].upper[slot])};
}

/// The layers, as bits, that have material on any of the lines within a segment; all layers from
/// the 32nd on share one bit.
HWY_INLINE uint32_t layers_with_matter(const ScanTile& tile, size_t slot, const Stretch& where,
                                       const RowMask& wanted) {
    uint32_t layers = 0;
    for (size_t k = 0; k < tile.layers.size(); ++k)
        if (any(overlap(matter_of(tile, k, slot), where) & wanted))
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

/// The lines of a chunk on which the plan may sweep material of these layers.
HWY_INLINE uint32_t lines_in_reach(const LanePlan& plan, const ScanTile& tile, size_t slot,
                                   uint32_t layers, const double* u, double v, double less) {
    return bits_of(in_reach(plan, u, v, less, [&](const auto& may_hold) HWY_ATTR {
        RowMask found = below(row_of(1.0), row_of(0.0));
        for_layers(tile, layers,
                   [&](size_t k) HWY_ATTR { found = found | may_hold(matter_of(tile, k, slot)); });
        return found;
    }));
}

/// An end of material for counting volume: the number of grid coordinates below it, and its height
/// above the border half way to the next one.
struct Counted {
    Row points, beyond;
};

/// A coordinate exactly on an end counts for neither an upper nor a lower end.
HWY_INLINE Counted counted(const TileTask& task, const Row& x, const RowMask& is_upper) {
    const ScanGrid& grid = *task.grid;
    const double half = grid.half_count[static_cast<size_t>(task.axis)];
    const double centre = grid.centre[task.axis];
    // Half way between two points, either is correct.
    const Row near = (x - centre) * (1.0 / grid.spacing) + (half - 0.5);
    const Row index = each<Row>([&](size_t k) HWY_ATTR { return hn::Round(near.part[k]); });
    const Row there = row_of(centre) + (index - half + 0.5) * grid.spacing;
    const RowMask counts = below(there, x) | but_not(at_most(there, x), is_upper);
    const Row points = index + choose(counts, row_of(1.0), row_of(0.0));
    return {points, x - (row_of(centre) + (points - half) * grid.spacing)};
}

/// The weight of an end from its stored form.
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

HWY_INLINE void add_to(double* sums, const RowMask& where, const Row& what) {
    store(load(sums) + choose(where, what, row_of(0.0)), sums);
}

HWY_INLINE void set_marks(uint32_t* marks, uint32_t which, uint32_t mark) {
    const hn::CappedTag<uint32_t, chunk> d;
    for (size_t i = 0; i < chunk; i += hn::Lanes(d)) {
        const uint32_t here = which >> i;
        const uint8_t bytes[8] = {static_cast<uint8_t>(here), static_cast<uint8_t>(here >> 8U)};
        const auto chosen = hn::LoadMaskBits(d, bytes);
        hn::Store(hn::IfThenElse(chosen, hn::Set(d, mark), hn::Load(d, marks + i)), d, marks + i);
    }
}

/// Counts what is removed when the intervals of a layer are shortened.
HWY_INLINE void count(const TileTask& task, const ScanTile::Marks& marks, size_t slot,
                      const Stretch& old, const Swept& gone, const RowMask& wanted,
                      const RowMask& from_below, const RowMask& from_above, TileCut& done) {
    const Row low = row_of(1.0) - tilt_of(gone.low_facing) * (1.0 / ScanTile::steepest);
    const Row high = row_of(1.0) - tilt_of(gone.high_facing) * (1.0 / ScanTile::steepest);
    // The removed segment ends at an old upper end or at the new lower end above it; likewise
    // below.
    const Counted upper = counted(task, choose(from_above, old.upper, gone.ends.upper), from_above);
    const Counted lower =
        counted(task, choose(from_below, old.lower, gone.ends.lower), but_not(wanted, from_below));
    const Row upper_facing = choose(from_above, facing_of(&marks.upper_tilt[slot]), high);
    const Row lower_facing = choose(from_below, facing_of(&marks.lower_tilt[slot]), low);
    const size_t lane = slot % ScanTile::side;
    add_to(&done.beyond[lane], wanted, upper.beyond * upper_facing - lower.beyond * lower_facing);
    if (task.axis == 2) add_to(&done.points[lane], wanted, upper.points - lower.points);
}

/// Shortens the intervals of a layer; those in `wanted` keep one end or are removed.
HWY_INLINE void trim(const TileTask& task, ScanTile& tile, size_t k, size_t slot, const Swept& gone,
                     const RowMask& wanted, TileCut& done) {
    const Stretch old = matter_of(tile, k, slot);
    const RowMask from_below = wanted & at_most(gone.ends.lower, old.lower);
    const RowMask from_above = wanted & at_most(old.upper, gone.ends.upper);
    const RowMask whole = from_below & from_above;
    done.layers |= 1U << std::min(k, size_t{31});
    if (any(from_below)) done.lower_chunks |= 1U << (slot / chunk);
    if (any(from_above)) done.upper_chunks |= 1U << (slot / chunk);
    store(choose(whole, row_of(infinity), choose(from_below, gone.ends.upper, old.lower)),
          &tile.layers[k].lower[slot]);
    store(choose(whole, row_of(-infinity), choose(from_above, gone.ends.lower, old.upper)),
          &tile.layers[k].upper[slot]);
    if (tile.marks.empty()) return;
    ScanTile::Marks& marks = tile.marks[k];
    count(task, marks, slot, old, gone, wanted, from_below, from_above, done);
    if (any(from_below)) {
        set_marks(&marks.lower[slot], bits_of(from_below), task.mark);
        keep_tilts(&marks.lower_tilt[slot], from_below, tilt_of(gone.high_facing));
    }
    if (any(from_above)) {
        set_marks(&marks.upper[slot], bits_of(from_above), task.mark);
        keep_tilts(&marks.upper_tilt[slot], from_above, tilt_of(gone.low_facing));
    }
}

void note_blocks(TileCut& done, size_t slot, uint32_t changed) {
    const size_t row = slot / ScanTile::side, first = slot % ScanTile::side / 4;
    for (size_t group = first; changed != 0; changed >>= 4U, ++group)
        if ((changed & 15U) != 0) done.blocks |= 1U << (row / 4 * 4 + group);
}

void note_by_hand(TileCut& done, size_t slot, uint32_t hard, const Swept& gone) {
    done.lower_chunks |= 1U << (slot / chunk);
    done.upper_chunks |= 1U << (slot / chunk);
    done.layers = ~0U; // a line may even get another interval
    std::array<double, chunk> lower, upper, low_tilts, high_tilts;
    store(gone.ends.lower, lower.data());
    store(gone.ends.upper, upper.data());
    store(tilt_of(gone.low_facing), low_tilts.data());
    store(tilt_of(gone.high_facing), high_tilts.data());
    for (; hard != 0; hard &= hard - 1) {
        const auto i = static_cast<size_t>(std::countr_zero(hard));
        done.by_hand[done.by_hand_count++] = {static_cast<uint32_t>(slot + i), lower[i], upper[i],
                                              static_cast<uint8_t>(low_tilts[i]),
                                              static_cast<uint8_t>(high_tilts[i])};
    }
}

/// Removes segments from a chunk of lines in the layers that hold material.
HWY_INLINE void take_chunk(const TileTask& task, ScanTile& tile, size_t slot, uint32_t layers,
                           const Swept& gone, TileCut& done) {
    RowMask hard = below(row_of(1.0), row_of(0.0));
    RowMask met = hard;
    const bool many = tile.layers.size() > 1;
    for_layers(tile, layers, [&](size_t k) HWY_ATTR {
        const Stretch old = matter_of(tile, k, slot);
        const RowMask over = overlap(old, gone.ends);
        const RowMask from_below = at_most(gone.ends.lower, old.lower);
        const RowMask from_above = at_most(old.upper, gone.ends.upper);
        met = met | over;
        hard = hard | but_not(over, from_below | from_above);
        if (many) hard = hard | (over & from_below & from_above);
    });
    if (!any(met)) return;
    for_layers(tile, layers, [&](size_t k) HWY_ATTR {
        const RowMask wanted = but_not(overlap(matter_of(tile, k, slot), gone.ends), hard);
        if (any(wanted)) trim(task, tile, k, slot, gone, wanted, done);
    });
    if (any(hard)) note_by_hand(done, slot, bits_of(hard), gone);
    note_blocks(done, slot, bits_of(met));
}

/// Calls `act(row, first lane, place, layers, lines)` for the chunks that the plan may affect, with
/// the lines and layers that it may affect.
template <typename Act>
HWY_INLINE void for_chunks_in_reach(const LanePlan& plan, const TileTask& task,
                                    const ScanTile& tile, const Act& act) {
    const Stretch range{row_of(task.low), row_of(task.high)};
    for (int row = task.row_first; row < task.row_last; ++row) {
        const double v = task.v[static_cast<size_t>(row)];
        for (size_t first = 0; first < ScanTile::side; first += chunk) {
            const uint32_t asked = (task.lanes >> first) & 0xffU;
            if (asked == 0) continue;
            const size_t slot = static_cast<size_t>(row) * ScanTile::side + first;
            const uint32_t layers = layers_with_matter(tile, slot, range, mask_of(asked));
            if (layers == 0) continue;
            const double less = task.grid ? 0.0 : safely_less; // as shared() does
            const uint32_t lines =
                lines_in_reach(plan, tile, slot, layers, task.u + first, v, less);
            if (lines != 0) act(row, first, slot, layers, lines);
        }
    }
}

HWY_ATTR void in_reach_of_tile(const LanePlan& plan, const TileTask& task, const ScanTile& tile,
                               TileReach& out) {
    out.fill(0);
    for_chunks_in_reach(
        plan, task, tile, [&](int row, size_t first, size_t, uint32_t, uint32_t lines) HWY_ATTR {
            out[static_cast<size_t>(row)] |= static_cast<uint16_t>((lines << first) & task.lanes);
        });
}

HWY_ATTR bool changes(const LanePlan& plan, const TileTask& task, const ScanTile& tile) {
    bool found = false;
    for_chunks_in_reach(plan, task, tile,
                        [&](int row, size_t first, size_t slot, uint32_t, uint32_t lines) HWY_ATTR {
                            if (found) return;
                            const double v = task.v[static_cast<size_t>(row)];
                            const Stretch gone = swept_of(plan, task.u + first, v, lines).ends;
                            for (size_t k = 0; k < tile.layers.size(); ++k)
                                found = found || any(overlap(matter_of(tile, k, slot), gone));
                        });
    return found;
}

HWY_ATTR void cut(const LanePlan& plan, const TileTask& task, ScanTile& tile, TileCut& done) {
    for_chunks_in_reach(
        plan, task, tile,
        [&](int row, size_t first, size_t slot, uint32_t layers, uint32_t lines) HWY_ATTR {
            const double v = task.v[static_cast<size_t>(row)];
            take_chunk(task, tile, slot, layers, swept_of(plan, task.u + first, v, lines), done);
        });
}

/// The intersection of the segments at the four corners of each cell, shortened by the error bound.
HWY_INLINE Stretch shared(const CornerStretches& front, const CornerStretches& back, size_t first) {
    const auto both = [&](const auto& one, const auto& other, const auto& act) HWY_ATTR {
        return act(act(load(&one[first]), load(&one[first + 1])),
                   act(load(&other[first]), load(&other[first + 1])));
    };
    const auto higher = [](const Row& a, const Row& b) HWY_ATTR { return most(a, b); };
    const auto lower = [](const Row& a, const Row& b) HWY_ATTR { return least(a, b); };
    return {both(front.lower, back.lower, higher) + safely_less,
            both(front.upper, back.upper, lower) - safely_less};
}

HWY_ATTR void take_shared(const TileTask& task, int row, const CornerStretches& front,
                          const CornerStretches& back, uint32_t cells, ScanTile& tile,
                          TileCut& done) {
    for (size_t first = 0; first < ScanTile::side; first += chunk, cells >>= chunk) {
        if ((cells & 0xffU) == 0) continue;
        const Stretch gone = shared(front, back, first);
        const RowMask some = below(gone.lower, gone.upper) & mask_of(cells & 0xffU);
        if (!any(some)) continue;
        const Stretch here{choose(some, gone.lower, row_of(infinity)),
                           choose(some, gone.upper, row_of(-infinity))};
        const size_t slot = static_cast<size_t>(row) * ScanTile::side + first;
        const uint32_t layers = layers_with_matter(tile, slot, here, some);
        if (layers != 0)
            take_chunk(task, tile, slot, layers, {here, row_of(1.0), row_of(1.0)}, done);
    }
}

HWY_ATTR bool meets_shared(const ScanTile& tile, int row, const CornerStretches& front,
                           const CornerStretches& back, uint32_t cells) {
    for (size_t first = 0; first < ScanTile::side; first += chunk, cells >>= chunk) {
        if ((cells & 0xffU) == 0) continue;
        const Stretch gone = shared(front, back, first);
        const RowMask some = below(gone.lower, gone.upper) & mask_of(cells & 0xffU);
        const size_t slot = static_cast<size_t>(row) * ScanTile::side + first;
        if (layers_with_matter(tile, slot, gone, some) != 0) return true;
    }
    return false;
}

const LaneCut* loops() {
    static constexpr LaneCut table = {stretches,        changes,      cut,
                                      in_reach_of_tile, meets_shared, take_shared};
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

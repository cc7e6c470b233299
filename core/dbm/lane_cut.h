#pragma once

#include "core/dbm/dbm.h"
#include "core/dbm/lane_plan.h"
#include "core/dbm/scan_lines.h"

namespace core {

/// The part of a tile that a sweep may change, and where its lines run.
struct TileTask {
    const double* u = nullptr; // places of the lines in a row, also of those beyond the last one
    const double* v = nullptr; // places of the rows
    int row_first = 0, row_last = 0; // rows of the tile, first .. last - 1
    uint32_t lanes = 0;              // bit i: line i of a row may be met
    double low = 0.0, high = 0.0;    // what is cut lies between these heights
    uint32_t mark = 0;               // for the ends that the cut makes
    const ScanGrid* grid = nullptr;  // by which volume is counted; none for columns
    int axis = 0;                    // of the lines
};

/// A stretch that must be taken out of a line by hand: it divides an interval or removes one.
struct HandCut {
    uint32_t place;
    double lower, upper;
    uint8_t low_tilt, high_tilt; // of these ends, see ScanTile::Marks
};

/// What a cut did to a tile.
struct TileCut {
    alignas(64) std::array<double, ScanTile::side> beyond{}; // removed, by lane: see LineSums
    alignas(64) std::array<double, ScanTile::side> points{};
    uint32_t blocks = 0; // bit i: 4 x 4 block i has changed
    size_t by_hand_count = 0;
    std::array<HandCut, ScanTile::lines> by_hand; // not done yet; 8 kB, left as they are
};

/// Lines of a tile, those of a row as bits.
using TileReach = std::array<uint16_t, ScanTile::side>;

/// Stretches on the corners of a row of cells, (+inf, -inf) where there is none or where nobody
/// has asked: one corner more than cells, filled up to whole chunks of 8.
struct alignas(64) CornerStretches {
    static constexpr size_t size = 24;
    std::array<double, size> lower, upper;

    CornerStretches() {
        lower.fill(infinity);
        upper.fill(-infinity);
    }
};

/// The inner loops of cutting, for the best instruction set of this processor. Each does the same
/// operations in the same order in every lane, without fused multiply-add: all of them give the
/// same bits.
struct LaneCut {
    /// The stretches on corners at `u` and `v` in what the plan sweeps; the ends lie in the swept
    /// volume up to rounding (1e-9 mm within 2 m). Only chunks with corners that are `wanted`, bit
    /// by bit, are written; corners that are not may come out empty.
    void (*stretches)(const LanePlan& plan, const double* u, double v, uint32_t wanted,
                      CornerStretches& out);

    /// Whether cutting the tile would change it.
    bool (*changes)(const LanePlan& plan, const TileTask& task, const ScanTile& tile);

    /// Takes what the plan sweeps out of the tile, but for what is left to be done by hand.
    void (*cut)(const LanePlan& plan, const TileTask& task, ScanTile& tile, TileCut& done);

    /// The lines that the task looks at of which the plan may sweep something, for its rows; it
    /// does of no others.
    void (*in_reach)(const LanePlan& plan, const TileTask& task, const ScanTile& tile,
                     TileReach& out);

    /// Whether these cells of a row hold matter within what their four corners share: corners
    /// 0 .. 16 in front and at the back.
    bool (*meets_shared)(const ScanTile& tile, int row, const CornerStretches& front,
                         const CornerStretches& back, uint32_t cells);

    /// Takes that out of them, but for what is left to be done by hand.
    void (*take_shared)(const TileTask& task, int row, const CornerStretches& front,
                        const CornerStretches& back, uint32_t cells, ScanTile& tile, TileCut& done);
};

/// The loops to use now.
const LaneCut& lane_cut();

} // namespace core

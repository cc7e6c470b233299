#pragma once

#include "core/dbm/dbm.h"
#include "core/dbm/lane_plan.h"
#include "core/dbm/scan_lines.h"

namespace core {

/// The part of a tile that a sweep may change, and the positions of its lines.
struct TileTask {
    const double* u = nullptr; // positions of the lines in a row, including those beyond the last
                               // one, in ascending order
    const double* v = nullptr; // positions of the rows
    int row_first = 0, row_last = 0; // rows of the tile, first .. last - 1
    uint32_t lanes = 0;              // bit i: line i of a row may be affected
    double low = 0.0, high = 0.0;    // the cut is between these heights
    uint32_t mark = 0;               // for the new ends
    const ScanGrid* grid = nullptr;  // for counting volume; null for columns
    int axis = 0;                    // of the lines
};

/// A segment that the lanes cannot remove from a line, because it divides an interval or removes
/// one.
struct ScalarCut {
    uint32_t slot;
    double lower, upper;
    uint8_t low_tilt, high_tilt; // of these ends, see ScanTile::Marks
};

/// The effect of a cut on a tile.
struct TileCut {
    alignas(
        64) std::array<double, ScanTile::side> beyond{}; // removed volume by lane: see RemovalSums
    alignas(64) std::array<double, ScanTile::side> points{};
    uint32_t blocks = 0; // bit i: 4 x 4 block i has changed
    // Bit i: a lower or an upper end in slots 8 i .. 8 i + 7 has changed; bit k: one in layer k,
    // the last bit: in any layer from the 31st on.
    uint32_t lower_chunks = 0, upper_chunks = 0, layers = 0;
    size_t by_hand_count = 0;
    std::array<ScalarCut, ScanTile::lines> by_hand; // not done yet; 8 kB, not initialised
};

/// Lines of a tile, one bit each, row by row.
using TileReach = std::array<uint16_t, ScanTile::side>;

/// Segments at the corners of a row of cells, (+inf, -inf) if there is none or it was not computed.
/// There is one corner more than cells, padded to whole chunks of 8.
struct alignas(64) CornerStretches {
    static constexpr size_t size = 24;
    std::array<double, size> lower, upper;

    CornerStretches() {
        lower.fill(infinity);
        upper.fill(-infinity);
    }
};

/// The inner loops of cutting for the best instruction set of this processor. Each performs the
/// same operations in the same order in every lane, without fused multiply-add: all instruction
/// sets give the same bits.
struct LaneCut {
    /// The segments at the corners `u`, `v` inside the volume that the plan sweeps; the ends are
    /// inside the swept volume up to rounding (1e-9 mm within 2 m). Writes only chunks with corners
    /// in the bit set `wanted`; other corners may come out empty.
    void (*stretches)(const LanePlan& plan, const double* u, double v, uint32_t wanted,
                      CornerStretches& out);

    /// Whether the cut would change the tile.
    bool (*changes)(const LanePlan& plan, const TileTask& task, const ScanTile& tile);

    /// Removes what the plan sweeps from the tile, except for the segments listed in
    /// `done.by_hand`.
    void (*cut)(const LanePlan& plan, const TileTask& task, ScanTile& tile, TileCut& done);

    /// The lines in the rows of the task that the plan may affect; it affects no others.
    void (*in_reach)(const LanePlan& plan, const TileTask& task, const ScanTile& tile,
                     TileReach& out);

    /// Whether these cells of a row contain material within the intersection of the segments at
    /// their four corners: corners 0 .. 16 at the front and at the back.
    bool (*meets_shared)(const ScanTile& tile, int row, const CornerStretches& front,
                         const CornerStretches& back, uint32_t cells);

    /// Removes that intersection from the cells, except for the segments listed in `done.by_hand`.
    void (*take_shared)(const TileTask& task, int row, const CornerStretches& front,
                        const CornerStretches& back, uint32_t cells, ScanTile& tile, TileCut& done);
};

/// The loops to use.
const LaneCut& lane_cut();

} // namespace core

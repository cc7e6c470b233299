#pragma once

#include "core/dbm/cut_model.h"
#include "core/dbm/cutter.h"
#include "core/dbm/lane_cut.h"

namespace core {

/// What was removed from lines, before it is made a volume: grid points, a cell each, and how far
/// the ends of what went lie beyond the borders of these cells.
struct LineSums {
    double beyond = 0.0; // mm, each end weighed by the square of its normal along the line
    double points = 0.0; // counted by the lines along Z
};

/// What a sweep did to a tile.
struct TileOutcome {
    LineSums removed;
    uint32_t blocks = 0; // bit i: 4 x 4 block i has changed
};

/// A sweep ready for cutting: where it can remove anything, and the mark for the ends it makes.
struct ReadySweep {
    const CutterSweep* sweep = nullptr;
    Aabb front;
    uint32_t mark = 0;
};

/// The tiles of a family that a range of lines touches: first .. last - 1 in both directions.
LineRange tiles_of(const LineRange& lines);

/// The lines of a family whose places lie in the box, the cells that meet it.
LineRange lines_in(const CutModel& model, int axis, const Aabb& box);
LineRange cells_in(const CutModel& model, const Aabb& box);

/// Runs `act` over the tiles that a range of lines touches, u fastest.
template <typename Act>
void for_tiles(const LineRange& lines, const TileBoxes& boxes, const Act& act) {
    if (lines.empty()) return;
    const LineRange tiles = tiles_of(lines);
    for (int v = tiles.v_first; v < tiles.v_last; ++v)
        for (int u = tiles.u_first; u < tiles.u_last; ++u)
            act(static_cast<size_t>(v * boxes.u_tiles + u));
}

/// Fits the boxes of all tiles that are stale.
void fit_boxes(CutModel& model);

/// Takes a convex piece out of those lines of one tile that are in the range. Nothing but the tile
/// is written to: several threads may work on different tiles of one model.
TileOutcome cut_lines(CutModel& model, size_t tile, const LineRange& range, const LanePlan& plan,
                      const ReadySweep& ready);

/// The same for columns; what is removed is not counted.
TileOutcome cut_columns(CutModel& model, size_t tile, const LineRange& range, const LanePlan& plan,
                        const ReadySweep& ready);

/// The box of what a sweep can remove from a stock, out of which the cutter standing at `from` has
/// been taken already; `top` is above all stock.
///
/// Proof: a point that the cutter comes to hold, and did not hold at `from`, lies on the way of a
/// point of its surface where the surface faces the motion. The box is that of those points and
/// their way.
Aabb front_bounds(const CutterSweep& sweep, double top);

} // namespace core

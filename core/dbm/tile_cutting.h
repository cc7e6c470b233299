#pragma once

#include "core/dbm/cut_model.h"
#include "core/dbm/cutter.h"
#include "core/dbm/lane_cut.h"

namespace core {

/// Removed material, before conversion to a volume: grid points, one cell each, and the lengths by
/// which removed segments extend beyond the borders of these cells.
struct RemovalSums {
    double beyond = 0.0; // mm, each end weighted by the square of its normal along the line
    double points = 0.0; // counted on the lines along Z
};

/// The effect of a sweep on a tile.
struct TileOutcome {
    RemovalSums removed;
    uint32_t blocks = 0; // bit i: 4 x 4 block i has changed
};

/// A sweep prepared for cutting: the box in which it can remove anything, and the mark of the ends
/// that it makes.
struct ReadySweep {
    const CutterSweep* sweep = nullptr;
    Aabb front;
    uint32_t mark = 0;
};

/// The tiles of a family that a range of lines touches: first .. last - 1 in both directions.
LineRange tiles_of(const LineRange& lines);

/// The lines of a family within the box.
LineRange lines_in(const CutModel& model, int axis, const Aabb& box);
/// The cells that overlap the box.
LineRange cells_in(const CutModel& model, const Aabb& box);

template <typename Act>
/// Calls `act` for the tiles that a range of lines touches, u fastest.
void for_tiles(const LineRange& lines, const TileBoxes& boxes, const Act& act) {
    if (lines.empty()) return;
    const LineRange tiles = tiles_of(lines);
    for (int v = tiles.v_first; v < tiles.v_last; ++v)
        for (int u = tiles.u_first; u < tiles.u_last; ++u)
            act(static_cast<size_t>(v * boxes.u_tiles + u));
}

/// Refits the outdated boxes of all tiles.
void fit_boxes(CutModel& model);

/// Removes a convex piece from the lines of one tile that are in the range. Writes only to the
/// tile: several threads may work on different tiles of one model.
TileOutcome cut_lines(CutModel& model, size_t tile, const LineRange& range, const LanePlan& plan,
                      const ReadySweep& ready);

/// Removes a convex piece from the columns of one tile; removed volume is not counted.
TileOutcome cut_columns(CutModel& model, size_t tile, const LineRange& range, const LanePlan& plan,
                        const ReadySweep& ready);

/// A box of what a sweep can remove from a stock from which the cutter at `from` was already
/// removed; `top` is above all stock.
///
/// Proof:   a point that the cutter enters lies on the path of a point of its surface where the
///          surface faces the motion. The box is that of those points and their paths.
Aabb front_bounds(const CutterSweep& sweep, double top);

} // namespace core

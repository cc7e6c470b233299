#pragma once

#include <optional>

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
    uint32_t blocks = 0;                                     // bit i: 4 x 4 block i has changed
    uint32_t lower_chunks = 0, upper_chunks = 0, layers = 0; // TileCut
};

/// A sweep prepared for cutting: the box in which it can remove anything, and the mark of the ends
/// that it makes.
struct ReadySweep {
    const CutterSweep* sweep = nullptr;
    Aabb front;
    uint32_t mark = 0;
};

/// Numbers of the families: those of lines by their axis, then the columns.
constexpr int column_family = 3;
constexpr int families = 4;

TileBoxes& boxes_of(CutModel& model, int family);
const TileBoxes& boxes_of(const CutModel& model, int family);
ScanLines& family_of(CutModel& model, int family);
const ScanLines& family_of(const CutModel& model, int family);
LinePositions positions_of(const CutModel& model, int family);

/// The tiles of a family that a range of lines touches: first .. last - 1 in both directions.
LineRange tiles_of(const LineRange& lines);

/// The lines of a family within the box.
LineRange lines_in(const CutModel& model, int axis, const Aabb& box);
/// The cells that overlap the box.
LineRange cells_in(const CutModel& model, const Aabb& box);

/// Calls `act` for the tiles that a range of lines touches, u fastest.
template <typename Act>
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

/// The lines or columns of a family that a sweep may change.
LineRange range_of(const CutModel& model, int family, const Aabb& front);

/// Prepares a sweep for cutting, as the next of the model's moves; empty if it does not come to the
/// box of the stock.
std::optional<ReadySweep> prepare(CutModel& model, const CutterSweep& sweep);

/// Prepares a sweep and adds it to the log; empty if it does not come near the stock.
std::optional<ReadySweep> begin(CutModel& model, const CutterSweep& sweep);

/// Refits the boxes of all tiles if many of them are outdated.
void fit_when_many_are_stale(CutModel& model);

/// Adds a removed volume to the volume owed and returns the part of it that can be reported now.
double reported(CutModel& model, const RemovalSums& sums);

template <typename Mine, typename Act>
/// Cuts the tiles of a family that `mine(tile)` accepts, and calls `act(piece, tile, outcome)`
/// after each, always in the same order.
void cut_tiles(CutModel& model, int family, const ReadySweep& ready, const Mine& mine,
               const Act& act) {
    const bool columns = family == column_family;
    if (columns && model.columns.u_count() == 0) return;
    const LineRange range = range_of(model, family, ready.front);
    uint32_t number = 0;
    for (const Cutter::Piece& piece : ready.sweep->cutter->pieces) {
        const RevolvedProfile& profile = columns ? piece.within : piece.around;
        const LanePlan plan =
            lane_plan(profile, *ready.sweep, columns ? 2 : family, model.outer_box.max.z);
        for_tiles(range, boxes_of(model, family), [&](size_t tile) {
            if (!mine(tile)) return;
            act(number, tile,
                columns ? cut_columns(model, tile, range, plan, ready)
                        : cut_lines(model, tile, range, plan, ready));
        });
        ++number;
    }
}

/// A box of what a sweep can remove from a stock from which the cutter at `from` was already
/// removed; `top` is above all stock.
///
/// Proof:   a point that the cutter enters lies on the path of a point of its surface where the
///          surface faces the motion. The box is that of those points and their paths.
Aabb front_bounds(const CutterSweep& sweep, double top);

} // namespace core

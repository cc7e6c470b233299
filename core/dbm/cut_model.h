#pragma once

#include <array>

#include "core/dbm/cutter.h"
#include "core/dbm/shared_log.h"
#include "core/dbm/solid.h"
#include "core/dbm/tile_boxes.h"

namespace core {

/// A stock as it is after some cuts: the discrete boundary model, an outer model that holds every
/// point of the stock, and the cuts themselves, from which either can be had again at any finer h.
///
/// The columns are the outer model of the Z family: cell (i, j) stands between lines i - 1, i and
/// j - 1, j, and its intervals hold every height at which the stock may have a point in the cell.
/// A copy is a snapshot; it shares whatever neither side has changed since.
struct CutModel {
    Solid solid;
    Aabb outer_box; // of the solid with its tolerance
    Dbm lines;
    ScanLines columns;
    std::array<TileBoxes, 3> line_boxes;
    TileBoxes column_boxes;
    SharedLog<LoggedSweep> log;
    std::vector<SharedLog<uint32_t>> history; // per tile of columns: the sweeps that came near it
};

/// The uncut model.
///
/// Errors: those of scan().
Result<CutModel> make_cut_model(Solid solid, double spacing,
                                double memory_limit = default_memory_limit);

/// Removes what one move of a cutter sweeps, and returns the volume, mm3.
///
/// The volume is the mean of what the three families of lines say, so that the parts of a cut add
/// up to the whole.
double cut(CutModel& model, const CutterSweep& sweep);

/// The square of a column, clipped to where the stock can be.
Square cell_square(const CutModel& model, int i, int j);

/// The heights that cell (i, j)'s part `square` may hold matter at, worked out afresh from the log.
IntervalList fresh_column(const CutModel& model, int i, int j, const Square& square);

/// The matter on a line along Z through cell (i, j), worked out afresh from the log.
IntervalList fresh_line(const CutModel& model, int i, int j, double x, double y);

/// The numbers of the logged sweeps that may have come into a box, in order.
std::vector<uint32_t> sweeps_near(const CutModel& model, const Aabb& box);

/// Whether the model holds no matter any more.
bool is_gone(const CutModel& model);

} // namespace core

#pragma once

#include <array>
#include <span>

#include "core/dbm/cutter.h"
#include "core/dbm/solid.h"
#include "core/dbm/sweep_log.h"
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
    ScanLines columns; // none, if the model was made without
    std::array<TileBoxes, 3> line_boxes;
    TileBoxes column_boxes;
    SweepLog log; // the moves that came near the stock; marks are numbers + 1
    std::vector<SharedLog<SweepRun>> history; // per tile of columns: which of them came near it
    CutterSweep last;                         // of all moves, near or not
    double volume_owed = 0.0;                 // removed, but not yet reported (see cut), mm3
    size_t loose_tests = 0;                   // of boxes, by searches since all boxes were fitted

    // Where lines run and where the corners of cells stand, along X, Y, Z.
    std::array<std::vector<double>, 3> places;
    std::array<std::vector<double>, 2> corners;
};

/// Whether a model keeps columns; without them it has no lower bound.
enum class WithColumns { no, yes };

/// The uncut model.
///
/// Errors: those of scan().
Result<CutModel> make_cut_model(Solid solid, double spacing,
                                double memory_limit = default_memory_limit,
                                WithColumns with_columns = WithColumns::yes);

/// Removes what one move of a cutter sweeps, and returns the volume, mm3.
///
/// The volume counts grid points and what ends lie beyond their cells, weighed by the normals there
/// (README.md, "Volume"): additive over cuts, and true to first order for faces of any direction.
/// One small cut alone may come out below 0; such a remainder is taken off the next ones, so that
/// nothing that is reported is negative and all of it adds up.
double cut(CutModel& model, const CutterSweep& sweep);

/// The same for many moves in order, on so many threads, and the volume that each removed.
///
/// Result: the same bits for any number of threads.
/// Cost:   on two threads some half of the time of one, if there are hundreds of moves.
std::vector<double> cut(CutModel& model, std::span<const CutterSweep> sweeps, unsigned threads);

/// Counts the boxes that a search has tested, and fits those round what has been cut since when
/// searches have spent as much on loose ones as the fitting costs. Changes no answer.
void note_search(CutModel& model, size_t box_tests);

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

#pragma once

#include <functional>
#include <vector>

#include "core/dbm/dbm.h"

namespace core {

struct CutModel;
struct RevolvedProfile;
struct Solid;
struct Square;

/// Columns that hold every point of a body, also between its scan lines.
///
/// The column (i, j) of a family along an axis is a closed cell of the plane across it, between the
/// lines i - 1, i and j - 1, j of the grid (the outermost reach to the border of `box`), and its
/// intervals hold every place along the axis at which the body may have a point in the cell.
struct OuterModel {
    ScanGrid grid;
    Aabb box;                        // holds the body
    std::vector<ScanLines> families; // of columns, one for each axis at most
};

/// Where along `axis` a body may have a point over a closed rectangle of the plane across it (the
/// next two axes in cyclic order, as `square.x` and `square.y`). May be off by scan_rounding() to
/// either side along the axis, and be that of a rectangle as much smaller.
using ColumnFunction = std::function<IntervalList(int axis, const Square& square)>;

ColumnFunction columns_of(const Primitive& primitive);
ColumnFunction columns_of(const RevolvedProfile& profile);

/// By column_of(), the body being turned so that the axis becomes Z.
ColumnFunction columns_of(const Solid& solid);

/// The model of any body that can answer for one column. `bounds` must hold the body; columns are
/// asked for, and kept, wider by scan_rounding().
///
/// Cost: one call for each cell of each family; 24 bytes per cell.
OuterModel outer_model(const Aabb& bounds, const ScanGrid& grid, const ColumnFunction& column,
                       std::initializer_list<int> axes = {2, 0, 1});

/// The columns of a stock as they stand: the Z family.
OuterModel outer_model(const CutModel& stock);

/// The cell `i` of a family across `axis`: its extent along that axis.
Interval cell_of(const OuterModel& model, int axis, int i);

/// Boxes that together hold every point of the body: in every cube of the grid the product of what
/// its columns say, runs of equal ones along the first family taken together.
///
/// Proof: README.md beside this file, "Outer models".
std::vector<Aabb> boxes_of(const OuterModel& model);

/// Whether no matter on the lines stands out of the columns along them by more than `error`.
bool holds(const OuterModel& model, const Dbm& lines, double error);

} // namespace core

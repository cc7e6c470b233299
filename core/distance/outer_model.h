#pragma once

#include <functional>
#include <vector>

#include "core/dbm/dbm.h"

namespace core {

struct RevolvedProfile;
struct Solid;
struct Square;

/// Columns that contain every point of a body, also between its scan lines.
///
/// The column (i, j) of a family along an axis is a closed cell of the plane across it, between the
/// lines i - 1, i and j - 1, j of the grid (the outermost cells extend to the border of `box`). Its
/// intervals contain every position along the axis at which the body may have a point in the cell.
struct OuterModel {
    ScanGrid grid;
    Aabb box;                        // contains the body
    std::vector<ScanLines> families; // of columns, at most one per axis
};

/// Positions along `axis` at which a body may have a point over a closed rectangle of the plane
/// across it (the next two axes in cyclic order, as `square.x` and `square.y`). May be off by
/// scan_rounding() along the axis, and may refer to a rectangle that is smaller by that amount.
using ColumnFunction = std::function<IntervalList(int axis, const Square& square)>;

ColumnFunction columns_of(const Primitive& primitive);
ColumnFunction columns_of(const RevolvedProfile& profile);

/// Uses column_of() on the body rotated so that the axis becomes Z.
ColumnFunction columns_of(const Solid& solid);

/// The model of a body given by a function for single columns. `bounds` must contain it; columns
/// are queried and stored wider by scan_rounding().
///
/// Cost:    one call for each cell of each family; 24 bytes per cell.
OuterModel outer_model(const Aabb& bounds, const ScanGrid& grid, const ColumnFunction& column,
                       std::initializer_list<int> axes = {2, 0, 1});

/// Cell `i` of a family across `axis`: its extent along that axis.
Interval cell_of(const OuterModel& model, int axis, int i);

} // namespace core

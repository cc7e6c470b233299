#pragma once

#include <vector>

#include "hwsim/memory_line.h"

namespace core {
class ScanLines;
struct CutModel;
struct OuterModel;
} // namespace core

namespace hwsim {

/// Columns of an outer model, and the borders of their cells: cell (i, j) is the rectangle from
/// (x[i], y[j]) to (x[i + 1], y[j + 1]), and its intervals contain all heights at which the body
/// may have a point over it.
struct ColumnCells {
    const core::ScanLines* columns = nullptr; // of the Z family
    std::vector<double> x, y;
};

ColumnCells cells_of(const core::CutModel& stock);

/// Errors: no columns along Z.
core::Result<ColumnCells> cells_of(const core::OuterModel& model);

/// Upright posts that contain the columns of one tile of the lines.
///
/// Result:  adjacent equal columns become one post. Posts are larger than the columns by two steps
///          of rounding, and sideways by another eighth of the longer side of a cell that is four
///          times as long as wide.
/// Errors:  coordinates out of the device's range.
core::Result<std::vector<Record>> posts_of_tile(const ColumnCells& cells, size_t tile);

/// The posts of all tiles.
core::Result<std::vector<Record>> posts_of(const ColumnCells& cells);

} // namespace hwsim

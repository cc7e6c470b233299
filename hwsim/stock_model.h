#pragma once

#include <memory>

#include "hwsim/model_tree.h"
#include "hwsim/post_cover.h"

namespace hwsim {

/// A stock as the device holds it: a tree of posts for each tile of columns, and above them a tree
/// whose shape is that of the grid. The host's copy of what it is made of; a plain value.
struct StockModel {
    /// A part of the upper tree, or a tile: what stands for it, and its lines.
    struct Part {
        Branch branch;
        std::vector<LineRun> runs;
    };
    core::ScanLines columns;        // as taken over last
    std::vector<double> x, y;       // ends of the cells
    std::vector<Part> tiles;        // by tile
    std::vector<Part> above;        // of the upper tree, in the order of its division
    std::optional<uint32_t> header; // none before the first update
    uint32_t epoch = 0;
    uint32_t leaf_size = 4;
};

/// What an update writes, and which lines are needed no more once everything before it is retired.
struct StockUpdate {
    std::vector<AddressedLine> lines;
    std::vector<LineRun> released;
    uint32_t header = 0;
    uint32_t epoch = 0;
    size_t tiles = 0; // rebuilt
};

/// All lines that a stock has in the memory.
std::vector<LineRun> lines_of(const StockModel& model);

StockModel stock_model(const ColumnCells& cells, uint32_t leaf_size = 4);

/// Whether these are the columns that were taken last.
bool is_current(const StockModel& model, const core::ScanLines& columns);

/// Takes over the columns as they are now: makes the lines of all tiles that the columns do not
/// share with those taken before, of what is above them, and of a new header. No line that the
/// device may be reading is touched.
///
/// Errors: what does not fit into the device's numbers or its memory; the model and the space are
///         then as before. The columns must be of the same grid.
/// Cost:   these tiles; a pointer comparison for all others.
core::Result<StockUpdate> update(StockModel& model, LineSpace& space,
                                 const core::ScanLines& columns);

} // namespace hwsim

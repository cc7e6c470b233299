#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "hwsim/memory_line.h"
#include "hwsim/post_cover.h"

namespace hwsim {

/// A tree or a part of one, and what holds it. The volume of none says nothing.
struct Branch {
    Reference reference;
    Volume volume;

    bool operator==(const Branch&) const = default;
};

/// A line and where it belongs.
struct AddressedLine {
    uint32_t address = 0;
    Line line;
};

/// Lines that are being made for the device: what is to be written, and the room it takes.
struct ModelWriter {
    LineSpace* space = nullptr;
    Side side = Side::work;
    uint32_t epoch = 0; // of all lines made
    std::vector<AddressedLine> lines;
    std::vector<LineRun> runs; // taken from the space, in order

    /// Errors: the memory is full.
    core::Result<uint32_t> add(const Node& node);
    core::Result<Branch> add_leaf(std::span<const Record> records); // 1 to 32
};

/// A tree over records, split at the median along the longest side of the box of their places until
/// no more than `leaf_size` are left. Same records, same tree.
///
/// Errors: no records; a record that reaches beyond the range of coordinates; a leaf size that is
///         not 1 to 32; the memory is full.
core::Result<Branch> add_tree(ModelWriter& writer, std::vector<Record> records, uint32_t leaf_size);

/// The node above two branches, either of which may be none; the other one itself if one is.
core::Result<Branch> add_above(ModelWriter& writer, const Branch& a, const Branch& b);

/// The header line of a model: what a slot of the device holds.
core::Result<uint32_t> add_header(ModelWriter& writer, const Branch& root);

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

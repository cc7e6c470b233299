#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/dbm/scan_lines.h"
#include "hwsim/memory_line.h"
#include "hwsim/post_cover.h"

namespace hwsim {

/// A tree or subtree and its bounding volume, which is undefined if the tree is empty.
struct Branch {
    Reference reference;
    Volume volume;
    Box box; // around its records; of spheres only

    bool operator==(const Branch&) const = default;
};

/// A line and its address.
struct AddressedLine {
    uint32_t address = 0;
    Line line;
};

/// Collects lines for the device: their contents and the memory that they take.
struct ModelWriter {
    LineSpace* space = nullptr;
    Side side = Side::work;
    Volumes volumes = Volumes::boxes;
    uint32_t epoch = 0; // of all new lines
    std::vector<AddressedLine> lines;
    std::vector<LineRun> runs; // allocated, in order

    /// Errors: the memory is full.
    core::Result<uint32_t> add(const Node& node);
    core::Result<Branch> add_leaf(std::span<const Record> records); // 1 to 32
};

/// The bounding sphere of some records, as in the paper: its centre is that of their box, rounded
/// to a step; its radius is the greatest distance from there to a point of a record, rounded up.
Volume sphere_round(std::span<const Record> records, Side side);

/// A tree over records, split at the median along the longest side of the box of their positions
/// down to `leaf_size` records. The same records give the same tree.
///
/// Errors:  no records; a record out of the range of coordinates; a leaf size that is not 1 to 32;
///          the memory is full.
core::Result<Branch> add_tree(ModelWriter& writer, std::vector<Record> records, uint32_t leaf_size);

/// The node above two branches; if one is empty, the other one itself. A sphere above two others
/// has the centre of the box of all records, and reaches to the corners of that box or to the far
/// sides of the two spheres, whichever is nearer.
core::Result<Branch> add_above(ModelWriter& writer, const Branch& a, const Branch& b);

/// The header line of a model, to be put into a slot of the device.
core::Result<uint32_t> add_header(ModelWriter& writer, const Branch& root);

/// A stock as stored in the device: a tree of posts for each tile of columns, and above them a tree
/// with the shape of the grid. The host's copy of its structure; a plain value.
struct StockModel {
    /// A part of the upper tree, or a tile: its branch and its lines.
    struct Part {
        Branch branch;
        std::vector<LineRun> runs;
    };
    core::ScanLines columns;        // at the last update
    std::vector<double> x, y;       // borders of the cells
    std::vector<Part> tiles;        // by tile
    std::vector<Part> above;        // of the upper tree, in the order of its division
    std::optional<uint32_t> header; // empty before the first update
    uint32_t epoch = 0;
    uint32_t leaf_size = 4;
    Volumes volumes = Volumes::boxes;
};

/// The lines that an update writes, and those that become free once all entries before it are
/// retired.
struct StockUpdate {
    std::vector<AddressedLine> lines;
    std::vector<LineRun> released;
    uint32_t header = 0;
    uint32_t epoch = 0;
    size_t tiles = 0; // rebuilt
};

/// All lines of a stock in the memory.
std::vector<LineRun> lines_of(const StockModel& model);

StockModel stock_model(const ColumnCells& cells, uint32_t leaf_size = 4,
                       Volumes volumes = Volumes::boxes);

/// Whether these are the columns of the last update.
bool is_current(const StockModel& model, const core::ScanLines& columns);

/// Updates the model to the current columns: creates the lines of all tiles that the columns do not
/// share with those of the last update, of the tree above them, and of a new header. Lines that the
/// device may be reading are not changed. After epoch 2^32 - 1 all lines are created anew, with
/// epoch 1.
///
/// Errors:  out of the device's range or memory; the model and the space are then unchanged. The
///          columns must have the same grid.
/// Cost:    proportional to these tiles; a pointer comparison for all others.
core::Result<StockUpdate> update(StockModel& model, LineSpace& space,
                                 const core::ScanLines& columns);

} // namespace hwsim

#pragma once

#include "core/dbm/contour.h"
#include "core/dbm/cut_model.h"
#include "render/stock_brick.h"

namespace render {

/// Cells per side of a brick.
constexpr int brick_cells = 32;

/// Normals computed for a brick earlier; unchanged ends keep theirs.
struct BrickMemory {
    struct Known {
        uint32_t edge;     // number of the edge in the brick
        double along;      // where its line crosses the surface
        bool found, upper; // see core::Crossing
        core::CrossedEdge crossing;
    };
    std::vector<Known> edges; // in order of their numbers
};

/// Reusable memory for making a brick.
struct BrickWorkspace {
    static constexpr int side = brick_cells + 2; // nodes: a cell more on each side

    std::vector<uint64_t> inside; // one word per row of nodes along X
    std::array<std::vector<uint64_t>, 3> votes;
    std::array<std::vector<int32_t>, 3> edges; // number of each node's edge along the axis
    std::vector<int32_t> cells;                // number of a cell's first vertex
    std::vector<uint8_t> corners;              // bit mask of the corners of a cell that are inside
};

/// The surface in brick (i, j, k): the quads around the edges that begin at its nodes.
///
/// Result:  a brick without triangles if there is no surface.
StockBrick contour_brick(const core::CutModel& model, const std::array<int, 3>& brick,
                         BrickMemory& memory, BrickWorkspace& workspace);

/// The displayed surface of a stock, updated while the stock is cut or stepped back.
///
/// Shape:   that of core::stock_mesh, in bricks of 32 cells without gaps.
/// Result:  depends only on the model, not on earlier updates.
class StockSurface {
public:
    /// Shows another state of the stock; only differences from the last one cost time. Returns the
    /// number of remade bricks.
    ///
    /// Cost:    comparing tile pointers; for changed tiles the lines; for changed bricks their
    ///          surface.
    size_t update(const core::CutModel& model);

    /// Clears everything: the next update makes all bricks. Use it for another program or set-up,
    /// because its moves have the same numbers.
    void reset();

    const StockBricks& bricks() const { return shown_; }

private:
    bool is_same_grid(const core::CutModel& model) const;
    void start(const core::CutModel& model);

    core::Dbm lines_; // at the last update
    bool started_ = false;
    std::array<int, 3> counts_{}; // bricks along X, Y, Z
    std::vector<BrickMemory> memory_;
    std::vector<std::shared_ptr<const StockBrick>> bricks_;
    StockBricks shown_;
    BrickWorkspace workspace_;
};

} // namespace render

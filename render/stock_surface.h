#pragma once

#include "core/dbm/contour.h"
#include "core/dbm/cut_model.h"
#include "render/stock_brick.h"

namespace render {

/// Cells to a side of a brick.
constexpr int brick_cells = 32;

/// Normals found for a brick before: an end that has not changed keeps its own.
struct BrickMemory {
    struct Known {
        uint32_t edge;     // number of the edge in the brick
        double along;      // where its line passes the surface
        bool found, upper; // see core::Crossing
        core::CrossedEdge crossing;
    };
    std::vector<Known> edges; // in order of their numbers
};

/// Room for making a brick, used again and again.
struct BrickWorkspace {
    static constexpr int side = brick_cells + 2; // nodes: a cell more on each side

    std::vector<uint64_t> inside; // a word for each row of nodes along X
    std::array<std::vector<uint64_t>, 3> votes;
    std::array<std::vector<int32_t>, 3> edges; // number of each node's edge along the axis
    std::vector<int32_t> cells;                // number of a cell's first vertex
    std::vector<uint8_t> corners;              // which corners of a cell are inside
};

/// The surface in brick (i, j, k): the quads round the edges that begin at its nodes.
///
/// Result: a brick without triangles if no surface passes.
StockBrick contour_brick(const core::CutModel& model, const std::array<int, 3>& brick,
                         BrickMemory& memory, BrickWorkspace& workspace);

/// The surface of a stock for the eye, kept up to date while the stock is cut or goes back in time.
///
/// Shape:  that of core::stock_mesh, in bricks of 32 cells that meet without a gap.
/// Result: the same for the same model, whatever was shown before.
class StockSurface {
public:
    /// Shows another state of the stock; any one will do, but only what differs from the last one
    /// costs. Returns how many bricks were made anew.
    ///
    /// Cost: comparing tile pointers; for changed tiles the lines; for touched bricks their
    /// surface.
    size_t update(const core::CutModel& model);

    /// Forgets everything: the next update makes all bricks. For another program or set-up, whose
    /// moves have the same numbers.
    void reset();

    const StockBricks& bricks() const { return shown_; }

private:
    bool is_same_grid(const core::CutModel& model) const;
    void start(const core::CutModel& model);

    core::Dbm lines_; // as they were when the bricks were made
    bool started_ = false;
    std::array<int, 3> counts_{}; // bricks along X, Y, Z
    std::vector<BrickMemory> memory_;
    std::vector<std::shared_ptr<const StockBrick>> bricks_;
    StockBricks shown_;
    BrickWorkspace workspace_;
};

/// The surface of a model made at once.
StockBricks stock_bricks(const core::CutModel& model);

} // namespace render

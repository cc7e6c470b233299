#pragma once

#include "core/dbm/contour.h"
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

} // namespace render

#pragma once

#include <memory>
#include <vector>

#include "render/triangle_mesh.h"

namespace render {

/// The surface of a part of the stock, 32 cells wide. Frame: the stock's.
struct StockBrick {
    static constexpr uint32_t raw = 0xFFFFFFFF;

    TriangleMesh mesh;            // open; all bricks together are closed
    std::vector<uint32_t> blocks; // triangles 2 k and 2 k + 1 were cut by blocks[k], or are raw
    TriangleMesh drawn;           // looks the same with fewer triangles
};

/// The bricks that contain any surface.
using StockBricks = std::vector<std::shared_ptr<const StockBrick>>;

} // namespace render

#pragma once

#include <array>
#include <cstdint>

namespace core {

/// The twelve edges of a cell. Corner c stands at (c & 1, c >> 1 & 1, c >> 2); edges 0-3 run along
/// X, 4-7 along Y, 8-11 along Z.
struct CellEdge {
    uint8_t lower, upper; // corners
};

constexpr std::array<CellEdge, 12> cell_edges = {{{0, 1},
                                                  {2, 3},
                                                  {4, 5},
                                                  {6, 7},
                                                  {0, 2},
                                                  {1, 3},
                                                  {4, 6},
                                                  {5, 7},
                                                  {0, 4},
                                                  {1, 5},
                                                  {2, 6},
                                                  {3, 7}}};

/// The pieces of a surface in a cell, for one way of its corners to be inside or outside: which
/// piece passes through each edge.
struct DualCell {
    static constexpr uint8_t none = 255;

    std::array<uint8_t, 12> piece{}; // none where the edge does not pass the surface
    uint8_t count = 0;               // pieces
};

/// The pieces where the corners in `inside`, a bit for each, are in the body. On a side whose
/// inside corners lie across from each other, these are not joined: neighbours agree.
const DualCell& dual_cell(uint8_t inside);

} // namespace core

#pragma once

#include <array>
#include <cstdint>

namespace core {

/// The twelve edges of a cell. Corner c is at (c & 1, c >> 1 & 1, c >> 2); edges 0-3 run along X,
/// 4-7 along Y, 8-11 along Z.
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

/// The pieces of a surface in a cell for one pattern of inside corners: the piece that passes
/// through each edge.
struct DualCell {
    static constexpr uint8_t none = 255;

    std::array<uint8_t, 12> piece{}; // none where the surface does not cross the edge
    uint8_t count = 0;               // number of pieces
};

/// The pieces for the corners in `inside`, one bit each. On a face with two diagonally opposite
/// inside corners, these are not joined; neighbouring cells agree.
const DualCell& dual_cell(uint8_t inside);

} // namespace core

#pragma once

#include <cstdint>
#include <vector>

#include "core/dbm/dbm.h"

namespace core {

/// A box round the matter in each tile of a family of lines or columns, and in each 4 x 4 block of
/// a tile; empty where there is none.
struct TileBoxes {
    static constexpr int block_side = 4;
    static constexpr int blocks_per_side = ScanLines::tile_side / block_side;
    static constexpr size_t blocks_per_tile = blocks_per_side * blocks_per_side;

    int u_tiles = 0;
    int v_tiles = 0;
    std::vector<Aabb> boxes;  // u fastest
    std::vector<Aabb> blocks; // of 4 x 4 lines, the 16 of a tile in a row, u fastest

    size_t index(int u, int v) const {
        return static_cast<size_t>(v / ScanLines::tile_side) * static_cast<size_t>(u_tiles)
               + static_cast<size_t>(u / ScanLines::tile_side);
    }

    size_t block_index(int u, int v) const {
        const int across = u % ScanLines::tile_side / block_side;
        const int along = v % ScanLines::tile_side / block_side;
        return index(u, v) * blocks_per_tile
               + static_cast<size_t>(along * blocks_per_side + across);
    }
};

/// A range of lines or cells, first .. last - 1 in both directions.
struct LineRange {
    int u_first = 0, u_last = 0, v_first = 0, v_last = 0;

    bool empty() const { return u_first >= u_last || v_first >= v_last; }
};

/// The lines of the tile with this index.
LineRange lines_of_tile(const ScanLines& lines, const TileBoxes& tiles, size_t tile);

/// The lines of one of its 4 x 4 blocks.
LineRange lines_of_block(const ScanLines& lines, const TileBoxes& tiles, size_t tile, size_t block);

TileBoxes empty_tile_boxes(const ScanLines& lines);

} // namespace core

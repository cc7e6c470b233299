#pragma once

#include <cstdint>
#include <vector>

#include "core/dbm/scan_lines.h"

namespace core {

/// Boxes around 4 x 4 boxes of the level below; empty where there is no material.
struct TileLevel {
    int u_count = 0, v_count = 0;
    std::vector<Aabb> boxes; // u fastest
};

/// A range along the lines, within a box, that contains no material; empty if none is known.
struct BoxGap {
    double from = 0.0, to = 0.0;

    bool empty() const { return from >= to; }
};

/// Boxes around the material in each tile of a family of lines or columns and in each 4 x 4 block
/// of a tile, with their widest gaps; empty where there is no material. Boxes of recently cut
/// blocks may be outdated: too large, never too small.
struct TileBoxes {
    static constexpr int block_side = 4;
    static constexpr int blocks_per_side = ScanLines::tile_side / block_side;
    static constexpr size_t blocks_per_tile = blocks_per_side * blocks_per_side;
    static constexpr size_t most_stale = 64; // tiles waiting for their boxes to be refitted

    int u_tiles = 0;
    int v_tiles = 0;
    std::vector<Aabb> boxes;        // u fastest
    std::vector<BoxGap> gaps;       // of the boxes
    std::vector<TileLevel> above;   // over the tiles; the last level is one box
    std::vector<Aabb> blocks;       // of 4 x 4 lines, 16 per tile, u fastest
    std::vector<BoxGap> block_gaps; // of the blocks
    std::vector<uint16_t>
        stale; // per tile: bit i is set if block i was cut since its box was fitted
    std::vector<uint32_t> stale_tiles; // tiles with any such block

    size_t index(int u, int v) const {
        return static_cast<size_t>(v / ScanLines::tile_side) * static_cast<size_t>(u_tiles)
               + static_cast<size_t>(u / ScanLines::tile_side);
    }

    /// Records cut blocks of a tile.
    void note(size_t tile, uint32_t cut_blocks) {
        if (cut_blocks == 0) return;
        if (stale[tile] == 0) stale_tiles.push_back(static_cast<uint32_t>(tile));
        stale[tile] = static_cast<uint16_t>(stale[tile] | cut_blocks);
    }
};

/// A range of lines or cells, first .. last - 1 in both directions.
struct LineRange {
    int u_first = 0, u_last = 0, v_first = 0, v_last = 0;

    bool empty() const { return u_first >= u_last || v_first >= v_last; }
};

/// The lines of the tile with this index.
LineRange lines_of_tile(const ScanLines& lines, const TileBoxes& tiles, size_t tile);

/// The lines of one of the 4 x 4 blocks of a tile.
LineRange lines_of_block(const ScanLines& lines, const TileBoxes& tiles, size_t tile, size_t block);

/// Positions of the lines: line i is at u[i], or, for columns (`cells`), cell i spans u[i] .. u[i +
/// 1].
struct LinePositions {
    const double* u = nullptr;
    const double* v = nullptr;
    bool cells = false;
};

/// The box around the material of a tile as it is now.
Aabb fitted_box(const TileBoxes& tiles, const ScanLines& lines, const LinePositions& positions,
                size_t tile);

/// The tiles, or boxes of a level, under one box of the level above: up to 4 x 4.
LineRange below(const TileBoxes& tiles, size_t level, size_t index);

/// Boxes for these lines, all empty and all outdated.
TileBoxes unfitted_boxes(const ScanLines& lines);

/// Refits all outdated boxes.
void fit(TileBoxes& tiles, const ScanLines& lines, const LinePositions& positions);

} // namespace core

#include "core/dbm/tile_boxes.h"

#include <algorithm>
#include <utility>

namespace core {
namespace {

Aabb box_of_block(const TileBoxes& tiles, const ScanLines& lines, const LinePlaces& places,
                  size_t tile, size_t block) {
    const LineRange range = lines_of_block(lines, tiles, tile, block);
    const int axis = lines.axis(), ua = u_axis(axis), va = v_axis(axis);
    const int wide = places.cells ? 1 : 0;
    Aabb box;
    for (int v = range.v_first; v < range.v_last; ++v) {
        for (int u = range.u_first; u < range.u_last; ++u) {
            const LineView line = lines.line(u, v);
            if (line.empty()) continue;
            box.min[axis] = std::min(box.min[axis], line.front().lower);
            box.max[axis] = std::max(box.max[axis], line.back().upper);
            box.min[ua] = std::min(box.min[ua], places.u[u]);
            box.max[ua] = std::max(box.max[ua], places.u[u + wide]);
            box.min[va] = std::min(box.min[va], places.v[v]);
            box.max[va] = std::max(box.max[va], places.v[v + wide]);
        }
    }
    return box;
}

constexpr int level_side = 4;

/// How many boxes a level has, counted from the tiles, which are level 0.
std::pair<int, int> level_size(const TileBoxes& tiles, size_t level) {
    if (level == 0) return {tiles.u_tiles, tiles.v_tiles};
    return {tiles.above[level - 1].u_count, tiles.above[level - 1].v_count};
}

void add_levels(TileBoxes& tiles) {
    while (true) {
        const auto [u, v] = level_size(tiles, tiles.above.size());
        if (u <= 1 && v <= 1 && !tiles.above.empty()) return;
        TileLevel level{(u + level_side - 1) / level_side, (v + level_side - 1) / level_side, {}};
        level.boxes.resize(static_cast<size_t>(level.u_count) * static_cast<size_t>(level.v_count));
        tiles.above.push_back(std::move(level));
    }
}

/// Fits the boxes over those of the level below with these numbers; afterwards `fitted` are theirs.
void fit_level(TileBoxes& tiles, size_t level, std::vector<uint32_t>& fitted) {
    TileLevel& mine = tiles.above[level];
    const auto below_across = static_cast<uint32_t>(level_size(tiles, level).first);
    for (uint32_t& i : fitted)
        i = i / below_across / level_side * static_cast<uint32_t>(mine.u_count)
            + i % below_across / level_side;
    std::sort(fitted.begin(), fitted.end());
    fitted.erase(std::unique(fitted.begin(), fitted.end()), fitted.end());
    const std::vector<Aabb>& parts = level == 0 ? tiles.boxes : tiles.above[level - 1].boxes;
    for (const uint32_t i : fitted) {
        Aabb whole;
        const LineRange range = below(tiles, level, i);
        for (int v = range.v_first; v < range.v_last; ++v)
            for (int u = range.u_first; u < range.u_last; ++u)
                whole.extend(parts[static_cast<size_t>(v) * below_across + static_cast<size_t>(u)]);
        mine.boxes[i] = whole;
    }
}

} // namespace

LineRange below(const TileBoxes& tiles, size_t level, size_t index) {
    const auto across = static_cast<size_t>(tiles.above[level].u_count);
    const auto [u_count, v_count] = level_size(tiles, level);
    const int u = static_cast<int>(index % across) * level_side;
    const int v = static_cast<int>(index / across) * level_side;
    return {u, std::min(u + level_side, u_count), v, std::min(v + level_side, v_count)};
}

LineRange lines_of_tile(const ScanLines& lines, const TileBoxes& tiles, size_t tile) {
    constexpr int side = ScanLines::tile_side;
    const int u = static_cast<int>(tile % static_cast<size_t>(tiles.u_tiles)) * side;
    const int v = static_cast<int>(tile / static_cast<size_t>(tiles.u_tiles)) * side;
    return {u, std::min(u + side, lines.u_count()), v, std::min(v + side, lines.v_count())};
}

LineRange lines_of_block(const ScanLines& lines, const TileBoxes& tiles, size_t tile,
                         size_t block) {
    const LineRange whole = lines_of_tile(lines, tiles, tile);
    const int side = TileBoxes::block_side;
    const int u = whole.u_first + static_cast<int>(block) % TileBoxes::blocks_per_side * side;
    const int v = whole.v_first + static_cast<int>(block) / TileBoxes::blocks_per_side * side;
    return {u, std::min(u + side, whole.u_last), v, std::min(v + side, whole.v_last)};
}

TileBoxes unfitted_boxes(const ScanLines& lines) {
    constexpr int side = ScanLines::tile_side;
    TileBoxes tiles;
    tiles.u_tiles = (lines.u_count() + side - 1) / side;
    tiles.v_tiles = (lines.v_count() + side - 1) / side;
    tiles.boxes.resize(lines.tile_count());
    tiles.blocks.resize(tiles.boxes.size() * TileBoxes::blocks_per_tile);
    tiles.stale.resize(tiles.boxes.size());
    for (size_t tile = 0; tile < tiles.boxes.size(); ++tile)
        if (lines.tile(tile) != nullptr) tiles.note(tile, 0xffff);
    if (!tiles.boxes.empty()) add_levels(tiles);
    return tiles;
}

void fit(TileBoxes& tiles, const ScanLines& lines, const LinePlaces& places) {
    for (const uint32_t tile : tiles.stale_tiles) {
        Aabb whole;
        for (size_t block = 0; block < TileBoxes::blocks_per_tile; ++block) {
            Aabb& box = tiles.blocks[tile * TileBoxes::blocks_per_tile + block];
            if ((tiles.stale[tile] >> block) & 1U)
                box = box_of_block(tiles, lines, places, tile, block);
            whole.extend(box);
        }
        tiles.boxes[tile] = whole;
        tiles.stale[tile] = 0;
    }
    std::vector<uint32_t> fitted = std::exchange(tiles.stale_tiles, {});
    for (size_t level = 0; level < tiles.above.size(); ++level) fit_level(tiles, level, fitted);
}

} // namespace core

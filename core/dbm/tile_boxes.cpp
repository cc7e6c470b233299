#include "core/dbm/tile_boxes.h"

#include <algorithm>
#include <array>
#include <utility>

namespace core {
namespace {

/// The box around the material of the lines of a tile that are in a range.
Aabb box_of_lines(const LineRange& range, const ScanLines& lines, const LinePositions& positions,
                  size_t tile) {
    constexpr int side = ScanTile::side;
    const int axis = lines.axis(), ua = u_axis(axis), va = v_axis(axis);
    const int wide = positions.cells ? 1 : 0;
    Aabb box;
    if (lines.tile(tile) == nullptr) return box;
    const std::vector<ScanTile::Layer>& layers = lines.tile(tile)->layers;
    // Of each column of lines; an empty line is (+inf, -inf). Without branches, compilers use
    // vectors.
    std::array<double, side> lower, upper;
    lower.fill(infinity);
    upper.fill(-infinity);
    const auto first = static_cast<size_t>(range.u_first % side);
    const size_t last = first + static_cast<size_t>(range.u_last - range.u_first);
    for (int v = range.v_first; v < range.v_last; ++v) {
        const auto row = static_cast<size_t>(v % side * side);
        double any_lower = infinity;
        for (size_t u = first; u < last; ++u) {
            lower[u] = std::min(lower[u], layers[0].lower[row + u]);
            any_lower = std::min(any_lower, layers[0].lower[row + u]);
        }
        for (const ScanTile::Layer& layer : layers)
            for (size_t u = first; u < last; ++u)
                upper[u] = std::max(upper[u], layer.upper[row + u]);
        if (any_lower == infinity) continue;
        box.min[va] = std::min(box.min[va], positions.v[v]);
        box.max[va] = std::max(box.max[va], positions.v[v + wide]);
    }
    for (size_t u = first; u < last; ++u) {
        if (lower[u] == infinity) continue;
        const int at = range.u_first + static_cast<int>(u - first);
        box.min[axis] = std::min(box.min[axis], lower[u]);
        box.max[axis] = std::max(box.max[axis], upper[u]);
        box.min[ua] = std::min(box.min[ua], positions.u[at]);
        box.max[ua] = std::max(box.max[ua], positions.u[at + wide]);
    }
    return box;
}

/// Finds the widest gap between stretches of material.
class GapSearch {
public:
    void add(double lower, double upper) {
        if (lower < upper) stretches_[count_++] = {lower, upper};
    }

    BoxGap widest() {
        std::sort(stretches_.begin(), stretches_.begin() + count_,
                  [](const Interval& a, const Interval& b) { return a.lower < b.lower; });
        BoxGap gap;
        for (int i = 1; i < count_; ++i) {
            const auto k = static_cast<size_t>(i);
            const double end = stretches_[k - 1].upper;
            if (stretches_[k].lower - end > gap.to - gap.from) gap = {end, stretches_[k].lower};
            stretches_[k].upper = std::max(stretches_[k].upper, end);
        }
        return gap;
    }

    static constexpr int most = 64;
    bool is_full() const { return count_ >= most; }

private:
    std::array<Interval, most> stretches_;
    int count_ = 0;
};

BoxGap gap_of_block(const TileBoxes& tiles, const ScanLines& lines, size_t tile, size_t block) {
    if (lines.tile(tile) == nullptr || lines.tile(tile)->layers.size() < 2) return {};
    const LineRange range = lines_of_block(lines, tiles, tile, block);
    GapSearch search;
    for (int v = range.v_first; v < range.v_last; ++v) {
        for (int u = range.u_first; u < range.u_last; ++u) {
            for (const Interval& matter : lines.line(u, v)) {
                if (search.is_full()) return {};
                search.add(matter.lower, matter.upper);
            }
        }
    }
    return search.widest();
}

/// The gap of a tile whose blocks are fitted.
BoxGap gap_of_tile(const TileBoxes& tiles, int axis, size_t tile) {
    const size_t first = tile * TileBoxes::blocks_per_tile;
    GapSearch search;
    for (size_t block = first; block < first + TileBoxes::blocks_per_tile; ++block) {
        const Aabb& box = tiles.blocks[block];
        const BoxGap& gap = tiles.block_gaps[block];
        if (box.empty()) continue;
        search.add(box.min[axis], gap.empty() ? box.max[axis] : gap.from);
        if (!gap.empty()) search.add(gap.to, box.max[axis]);
    }
    return search.widest();
}

constexpr int level_side = 4;

/// Number of boxes of a level along u and v; level 0 are the tiles.
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

/// Fits the boxes above those of the level below with the numbers in `fitted`, and replaces these
/// numbers by their own.
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
    tiles.gaps.resize(tiles.boxes.size());
    tiles.blocks.resize(tiles.boxes.size() * TileBoxes::blocks_per_tile);
    tiles.block_gaps.resize(tiles.blocks.size());
    tiles.stale.resize(tiles.boxes.size());
    for (size_t tile = 0; tile < tiles.boxes.size(); ++tile)
        if (lines.tile(tile) != nullptr) tiles.note(tile, 0xffff);
    if (!tiles.boxes.empty()) add_levels(tiles);
    return tiles;
}

Aabb fitted_box(const TileBoxes& tiles, const ScanLines& lines, const LinePositions& positions,
                size_t tile) {
    return box_of_lines(lines_of_tile(lines, tiles, tile), lines, positions, tile);
}

void fit(TileBoxes& tiles, const ScanLines& lines, const LinePositions& positions) {
    for (const uint32_t tile : tiles.stale_tiles) {
        Aabb whole;
        for (size_t block = 0; block < TileBoxes::blocks_per_tile; ++block) {
            Aabb& box = tiles.blocks[tile * TileBoxes::blocks_per_tile + block];
            if ((tiles.stale[tile] >> block) & 1U) {
                box =
                    box_of_lines(lines_of_block(lines, tiles, tile, block), lines, positions, tile);
                tiles.block_gaps[tile * TileBoxes::blocks_per_tile + block] =
                    gap_of_block(tiles, lines, tile, block);
            }
            whole.extend(box);
        }
        tiles.boxes[tile] = whole;
        tiles.gaps[tile] = gap_of_tile(tiles, lines.axis(), tile);
        tiles.stale[tile] = 0;
    }
    std::vector<uint32_t> fitted = std::exchange(tiles.stale_tiles, {});
    for (size_t level = 0; level < tiles.above.size(); ++level) fit_level(tiles, level, fitted);
}

} // namespace core

#include "core/dbm/cut_memory.h"

namespace core {
namespace {

constexpr double bytes_per_tile_box =
    sizeof(Aabb) * (1.0 + TileBoxes::blocks_per_tile) + sizeof(uint16_t) + sizeof(void*) * 2.0;

double tiles_for(double lines) { return std::ceil(lines / ScanLines::tile_side); }

double bytes_of(const ScanLines& lines) {
    double bytes = 0.0;
    for (size_t i = 0; i < lines.tile_count(); ++i) {
        const ScanTile* tile = lines.tile(i);
        if (tile == nullptr) continue;
        bytes += static_cast<double>(tile->layers.capacity() * sizeof(ScanTile::Layer)
                                     + tile->marks.capacity() * sizeof(ScanTile::Marks));
    }
    return bytes + static_cast<double>(lines.tile_count()) * bytes_per_tile_box;
}

} // namespace

double cut_memory_estimate(const Aabb& bounds, double spacing, WithColumns with_columns) {
    double bytes = 0.0;
    const Vec3 size = bounds.size();
    const auto tiles = [&](int axis, double more) {
        return tiles_for(lines_across(size[u_axis(axis)], spacing) + more)
               * tiles_for(lines_across(size[v_axis(axis)], spacing) + more);
    };
    constexpr double marked = sizeof(ScanTile::Layer) + sizeof(ScanTile::Marks);
    for (int axis = 0; axis < 3; ++axis) bytes += tiles(axis, 0.0) * (marked + bytes_per_tile_box);
    if (with_columns == WithColumns::yes)
        bytes += tiles(2, 1.0) * (sizeof(ScanTile::Layer) + bytes_per_tile_box);
    return bytes;
}

double memory_of(const CutModel& model) {
    double bytes = bytes_of(model.columns);
    for (const ScanLines& family : model.lines.families) bytes += bytes_of(family);
    return bytes;
}

} // namespace core

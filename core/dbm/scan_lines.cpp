#include "core/dbm/scan_lines.h"

#include <atomic>

namespace core {
namespace {

constexpr int tiles_for(int lines) {
    return (lines + ScanLines::tile_side - 1) / ScanLines::tile_side;
}

} // namespace

ScanLines::ScanLines(int axis, int u_count, int v_count)
    : axis_(axis),
      u_count_(u_count),
      v_count_(v_count),
      u_tiles_(static_cast<size_t>(tiles_for(u_count))),
      tiles_(static_cast<size_t>(tiles_for(u_count)) * static_cast<size_t>(tiles_for(v_count))) {
    assert(axis >= 0 && axis < 3 && u_count >= 0 && v_count >= 0);
}

ScanLines::Edit& ScanLines::Edit::operator=(const LineView& matter) {
    set_line(tile_, place_, matter);
    return *this;
}

void ScanLines::Edit::add(const Interval& interval) {
    IntervalList list = tile_.line(place_).list();
    list.add(interval);
    set_line(tile_, place_, list);
}

ScanTile& ScanLines::edit_tile(size_t index) {
    auto& tile = tiles_[index];
    if (!tile) {
        tile = std::make_shared<ScanTile>();
    } else if (tile.use_count() > 1) {
        tile = std::make_shared<ScanTile>(*tile);
    } else {
        // use_count is a relaxed read: without the fence, reads of a snapshot that another thread
        // has just dropped could still be under way when we write.
        std::atomic_thread_fence(std::memory_order_acquire);
    }
    return *tile;
}

bool ScanLines::shares_tile(const ScanLines& other, int u, int v) const {
    return tiles_[tile_of(u, v)] == other.tiles_[other.tile_of(u, v)];
}

bool ScanLines::operator==(const ScanLines& other) const {
    if (axis_ != other.axis_ || u_count_ != other.u_count_ || v_count_ != other.v_count_)
        return false;
    for (int v = 0; v < v_count_; ++v)
        for (int u = 0; u < u_count_; ++u)
            if (!shares_tile(other, u, v) && !(line(u, v) == other.line(u, v))) return false;
    return true;
}

} // namespace core

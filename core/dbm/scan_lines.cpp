#include "core/dbm/scan_lines.h"

#include <atomic>

namespace core {
namespace {

/// An interval with the marks of its ends.
struct Marked {
    Interval interval;
    EndMarks marks;
};

Marked at(const ScanTile& tile, size_t slot, size_t k) {
    return {{tile.layers[k].lower[slot], tile.layers[k].upper[slot]}, tile.marks_of(slot, k)};
}

void put(ScanTile& tile, size_t slot, size_t k, const Marked& what) {
    if (k == tile.layers.size()) {
        tile.layers.emplace_back();
        if (!tile.marks.empty()) tile.keep_marks();
    }
    tile.layers[k].lower[slot] = what.interval.lower;
    tile.layers[k].upper[slot] = what.interval.upper;
    if (tile.marks.empty()) return;
    tile.marks[k].lower[slot] = what.marks.lower;
    tile.marks[k].upper[slot] = what.marks.upper;
    tile.marks[k].lower_tilt[slot] = what.marks.lower_tilt;
    tile.marks[k].upper_tilt[slot] = what.marks.upper_tilt;
}

constexpr Marked no_matter{{infinity, -infinity}, {}};

} // namespace

ScanTile::Layer::Layer() {
    lower.fill(infinity);
    upper.fill(-infinity);
}

void set_line(ScanTile& tile, size_t slot, const LineView& matter) {
    const size_t before = tile.line(slot).size();
    for (size_t k = 0; k < matter.size(); ++k) put(tile, slot, k, {matter[k], {}});
    for (size_t k = matter.size(); k < before; ++k) put(tile, slot, k, no_matter);
}

double subtract(ScanTile& tile, size_t slot, const Interval& cut, const EndMarks& made) {
    const size_t size = tile.line(slot).size();
    double removed = 0.0;
    std::vector<Marked> kept;
    for (size_t k = 0; k < size; ++k) {
        const Marked old = at(tile, slot, k);
        const auto& [lower, upper] = old.interval;
        if (!(lower < cut.upper && upper > cut.lower)) {
            kept.push_back(old);
            continue;
        }
        removed += std::min(upper, cut.upper) - std::max(lower, cut.lower);
        if (lower < cut.lower)
            kept.push_back({{lower, cut.lower},
                            {old.marks.lower, made.upper, old.marks.lower_tilt, made.upper_tilt}});
        if (upper > cut.upper)
            kept.push_back({{cut.upper, upper},
                            {made.lower, old.marks.upper, made.lower_tilt, old.marks.upper_tilt}});
    }
    if (removed == 0.0) return 0.0;
    for (size_t k = 0; k < kept.size(); ++k) put(tile, slot, k, kept[k]);
    for (size_t k = kept.size(); k < size; ++k) put(tile, slot, k, no_matter);
    return removed;
}

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
    set_line(tile_, slot_, matter);
    return *this;
}

void ScanLines::Edit::add(const Interval& interval) {
    IntervalList list = tile_.line(slot_).list();
    list.add(interval);
    set_line(tile_, slot_, list);
}

ScanTile& ScanLines::edit_tile(size_t index) {
    auto& tile = tiles_[index];
    if (!tile) {
        tile = std::make_shared<ScanTile>();
    } else if (tile.use_count() > 1) {
        tile = std::make_shared<ScanTile>(*tile);
    } else {
        // use_count is a relaxed read: without the fence, reads of a snapshot that another thread
        // has just dropped could still be in progress when we write.
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

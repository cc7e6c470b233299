#include "app/session/keyframes.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace app {
namespace {

constexpr double near_spacing = 0.012; // seconds of work between keyframes, where one looks
constexpr double far_spacing = 0.04;   // elsewhere, as far as there is memory
constexpr double longest_wait = 0.5;   // that a jump may take

/// How long a wait may be for places that are so many seconds of work away from where one looks.
double bearable_wait(double away) { return std::clamp(away / 8.0, 0.02, longest_wait); }

size_t bytes_of(const core::ScanTile& tile) {
    return sizeof(tile) + tile.layers.capacity() * sizeof(core::ScanTile::Layer)
           + tile.marks.capacity() * sizeof(core::ScanTile::Marks);
}

size_t bytes_apart(const core::ScanLines& lines, const core::ScanLines& other) {
    size_t bytes = lines.tile_count() * sizeof(std::shared_ptr<core::ScanTile>);
    const bool comparable = lines.tile_count() == other.tile_count();
    for (size_t i = 0; i < lines.tile_count(); ++i)
        if (lines.tile(i) && (!comparable || lines.tile(i) != other.tile(i)))
            bytes += bytes_of(*lines.tile(i));
    return bytes;
}

size_t bytes_of(const core::TileBoxes& boxes) {
    size_t bytes =
        boxes.boxes.size() * sizeof(core::Aabb) + boxes.gaps.size() * sizeof(core::BoxGap)
        + boxes.blocks.size() * sizeof(core::Aabb) + boxes.block_gaps.size() * sizeof(core::BoxGap)
        + boxes.stale.size() * sizeof(uint16_t);
    for (const core::TileLevel& level : boxes.above)
        bytes += level.boxes.size() * sizeof(core::Aabb);
    return bytes;
}

/// Logs in chunks: their pointers, and the last chunk, which each copy may have to itself.
size_t bytes_of_logs(const core::CutModel& stock) {
    constexpr size_t pointer = sizeof(std::shared_ptr<void>);
    constexpr size_t per_tile = 64; // a list of chunks, and its one chunk's pointer
    return 3 * pointer * (stock.log.size() / 64 + 1) + stock.history.size() * per_tile;
}

} // namespace

size_t bytes_apart(const RunPlace& place, const RunPlace& other) {
    constexpr size_t of_the_rest = 16384; // of the control, the clock and the rules, about
    const core::CutModel& stock = place.machine.stock;
    const core::CutModel& other_stock = other.machine.stock;
    size_t bytes = of_the_rest + bytes_of(stock.column_boxes) + bytes_of_logs(stock)
                   + bytes_apart(stock.columns, other_stock.columns);
    for (size_t axis = 0; axis < 3; ++axis)
        bytes += bytes_of(stock.line_boxes[axis])
                 + bytes_apart(stock.lines.families[axis], other_stock.lines.families[axis]);
    return bytes;
}

size_t Keyframes::index_after(size_t blocks) const {
    const auto is_before = [](size_t wanted, const Keyframe& frame) {
        return wanted < frame.blocks;
    };
    const auto after = std::upper_bound(frames_.begin(), frames_.end(), blocks, is_before);
    return static_cast<size_t>(after - frames_.begin());
}

bool Keyframes::wants(size_t blocks, double seconds) const {
    if (frames_.empty()) return true;
    const Keyframe& last = before(blocks);
    if (last.blocks == blocks) return false;
    const double spacing = std::abs(seconds - focus_) < 1.0 ? near_spacing : far_spacing;
    return seconds - last.seconds >= spacing;
}

const Keyframe& Keyframes::before(size_t blocks) const {
    const size_t after = index_after(blocks);
    assert(after > 0);
    return frames_[after - 1];
}

void Keyframes::note(size_t blocks, double seconds, const RunPlace& place) {
    if (!wants(blocks, seconds)) return;
    const size_t after = index_after(blocks);
    const size_t bytes = bytes_apart(place, after == 0 ? place : frames_[after - 1].place);
    frames_.insert(frames_.begin() + static_cast<std::ptrdiff_t>(after),
                   {blocks, seconds, place, bytes});
    memory_ += bytes;
    thin_out();
}

void Keyframes::drop_after(size_t blocks) {
    while (frames_.size() > 1 && frames_.back().blocks > blocks) remove(frames_.size() - 1);
}

double Keyframes::worth(size_t index) const {
    const double begin = frames_[index - 1].seconds;
    const bool is_last = index + 1 == frames_.size();
    const double gap = (is_last ? frames_[index].seconds : frames_[index + 1].seconds) - begin;
    return gap / bearable_wait(std::abs(frames_[index].seconds - focus_));
}

void Keyframes::remove(size_t index) {
    memory_ -= frames_[index].bytes;
    if (index + 1 < frames_.size()) {
        Keyframe& next = frames_[index + 1];
        memory_ -= next.bytes;
        next.bytes = bytes_apart(next.place, frames_[index - 1].place);
        memory_ += next.bytes;
    }
    frames_.erase(frames_.begin() + static_cast<std::ptrdiff_t>(index));
}

void Keyframes::thin_out() {
    while (memory_ > budget_ && frames_.size() > 2) {
        size_t least = 1;
        for (size_t i = 2; i < frames_.size(); ++i)
            if (worth(i) < worth(least)) least = i;
        remove(least);
    }
}

} // namespace app

#include "app/session/keyframes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

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

/// Logs in chunks: their pointers, and the last chunk, which each copy may have to itself.
size_t bytes_of_logs(const core::CutModel& stock) {
    constexpr size_t pointer = sizeof(std::shared_ptr<void>);
    constexpr size_t per_tile = 64; // a list of chunks, and its one chunk's pointer
    return 3 * pointer * (stock.log.size() / 64 + 1) + stock.history.size() * per_tile;
}

/// The boxes of a stock: those of its three families of lines, and of its columns.
core::TileBoxes& boxes_of(core::CutModel& stock, size_t i) {
    return i < 3 ? stock.line_boxes[i] : stock.column_boxes;
}

/// Bytes of a keyframe that it does not share with another one.
size_t bytes_apart(const Keyframe& frame, const Keyframe& other) {
    constexpr size_t of_the_rest = 16384; // of the control, the clock and the rules, about
    const core::CutModel& stock = frame.place.machine.stock;
    const core::CutModel& other_stock = other.place.machine.stock;
    size_t bytes =
        of_the_rest + bytes_of_logs(stock) + bytes_apart(stock.columns, other_stock.columns);
    for (size_t axis = 0; axis < 3; ++axis)
        bytes += bytes_apart(stock.lines.families[axis], other_stock.lines.families[axis]);
    for (size_t i = 0; i < frame.boxes.size(); ++i)
        bytes += frame.boxes[i].bytes_apart(other.boxes[i]);
    return bytes;
}

} // namespace

RunPlace Keyframe::restored() const {
    RunPlace whole = place;
    for (size_t i = 0; i < boxes.size(); ++i)
        boxes_of(whole.machine.stock, i) = app::restored(boxes[i]);
    return whole;
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
    static const Keyframe nothing;
    const Keyframe& before = after == 0 ? nothing : frames_[after - 1];
    Keyframe frame{blocks, seconds, place, {}, 0};
    for (size_t i = 0; i < frame.boxes.size(); ++i)
        frame.boxes[i] =
            kept(std::exchange(boxes_of(frame.place.machine.stock, i), {}), before.boxes[i]);
    frame.bytes = bytes_apart(frame, before);
    memory_ += frame.bytes;
    frames_.insert(frames_.begin() + static_cast<std::ptrdiff_t>(after), std::move(frame));
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
        next.bytes = bytes_apart(next, frames_[index - 1]);
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

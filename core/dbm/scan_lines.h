#pragma once

#include <array>
#include <cassert>
#include <memory>
#include <vector>

#include "core/dbm/interval.h"

namespace core {

/// The axis along which the first (u) and the second (v) index of a family of lines count:
/// X has (Y, Z), Y has (Z, X), Z has (X, Y).
constexpr int u_axis(int axis) { return (axis + 1) % 3; }
constexpr int v_axis(int axis) { return (axis + 2) % 3; }

/// One family of scan lines along `axis`, u_count x v_count of them. Lines live in tiles that
/// copies share until one of them edits: a copy is a snapshot and costs a pointer per tile.
///
/// Copies may be edited from several threads; one and the same object, tile by tile.
class ScanLines {
public:
    static constexpr int tile_side = 16;

    ScanLines() = default;
    ScanLines(int axis, int u_count, int v_count);

    int axis() const { return axis_; }
    int u_count() const { return u_count_; }
    int v_count() const { return v_count_; }

    const IntervalList& line(int u, int v) const {
        const auto& tile = tiles_[tile_of(u, v)];
        return tile ? (*tile)[place_in_tile(u, v)] : nothing;
    }

    /// The line, to be changed. Its tile is cloned first if another snapshot shares it.
    IntervalList& edit(int u, int v);

    /// Whether both hold the very same tile around the line, so that it need not be compared.
    bool shares_tile(const ScanLines& other, int u, int v) const;

    bool operator==(const ScanLines& other) const;

private:
    using Tile = std::array<IntervalList, static_cast<size_t>(tile_side) * tile_side>;

    static const IntervalList nothing;

    static constexpr size_t place_in_tile(int u, int v) {
        return static_cast<size_t>(u % tile_side)
               + static_cast<size_t>(v % tile_side) * static_cast<size_t>(tile_side);
    }
    size_t tile_of(int u, int v) const {
        assert(u >= 0 && u < u_count_ && v >= 0 && v < v_count_);
        return static_cast<size_t>(u / tile_side) + static_cast<size_t>(v / tile_side) * u_tiles_;
    }

    int axis_ = 0;
    int u_count_ = 0;
    int v_count_ = 0;
    size_t u_tiles_ = 0;
    std::vector<std::shared_ptr<Tile>> tiles_; // null: no line of the tile holds anything
};

} // namespace core

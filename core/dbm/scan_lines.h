#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/vec.h"
#include "core/dbm/interval.h"

namespace core {

/// Origin of the ends of an interval: 0 for raw stock, else the number of a cut.
struct EndMarks {
    uint32_t lower = 0, upper = 0;
    uint8_t lower_tilt = 0, upper_tilt = 0; // see ScanTile::Marks

    bool operator==(const EndMarks&) const = default;
};

/// The lines of a tile, in layers: layer k holds the k-th interval of every line, all lower ends
/// and all upper ends side by side, so that rows of lines can be processed in vector lanes.
///
/// Most lines hold one interval or none. A line without a k-th interval has (+inf, -inf) in layer
/// k, which overlaps nothing.
struct ScanTile {
    static constexpr int side = 16;
    static constexpr size_t lines = static_cast<size_t>(side) * side;

    struct alignas(64) Layer {
        std::array<double, lines> lower, upper;
        Layer();
    };
    /// The tilt of an end is steepest * (1 - n^2), where n is the component of the surface normal
    /// along the line: 0 where the surface faces along the line or its normal is unknown,
    /// `steepest` where the line runs along the surface.
    struct alignas(64) Marks {
        std::array<uint32_t, lines> lower{}, upper{};
        std::array<uint8_t, lines> lower_tilt{}, upper_tilt{};
    };
    static constexpr int steepest = 255;
    std::vector<Layer> layers = std::vector<Layer>(1);
    std::vector<Marks> marks; // one per layer, or none while all are 0

    LineView line(size_t slot) const {
        size_t size = 0;
        while (size < layers.size() && layers[size].lower[slot] < layers[size].upper[slot]) ++size;
        constexpr std::ptrdiff_t stride = sizeof(Layer) / sizeof(double);
        return {&layers[0].lower[slot], &layers[0].upper[slot], stride, size};
    }
    EndMarks marks_of(size_t slot, size_t interval) const {
        if (marks.empty()) return {};
        const Marks& m = marks[interval];
        return {m.lower[slot], m.upper[slot], m.lower_tilt[slot], m.upper_tilt[slot]};
    }
    /// Allocates marks; from now on they are stored for every end.
    void keep_marks() { marks.resize(layers.size()); }
};

/// Replaces the material of a line; all its ends count as raw stock.
void set_line(ScanTile& tile, size_t slot, const LineView& matter);

/// Removes `cut` from a line and returns the removed length. If the tile keeps marks, the new ends
/// get those in `made`: the lower end of the remaining material, at the upper end of `cut`, gets
/// the lower mark.
double subtract(ScanTile& tile, size_t slot, const Interval& cut, const EndMarks& made);

/// The axes along which the first (u) and second (v) index of a family of lines count: (Y, Z) for
/// X, (Z, X) for Y, (X, Y) for Z.
constexpr int u_axis(int axis) { return (axis + 1) % 3; }
constexpr int v_axis(int axis) { return (axis + 2) % 3; }

/// One family of scan lines along `axis`, u_count x v_count of them. Lines are stored in tiles that
/// copies share until one of them changes: a copy is a snapshot and costs a pointer per tile.
///
/// Copies may be edited from several threads; a single object only tile by tile.
class ScanLines {
public:
    static constexpr int tile_side = ScanTile::side;

    /// Write access to a line.
    class Edit {
    public:
        Edit(ScanTile& tile, size_t slot) : tile_(tile), slot_(slot) {}
        Edit& operator=(const LineView& matter);
        /// As for IntervalList; new ends count as raw stock.
        void add(const Interval& interval);
        double subtract(const Interval& cut) { return core::subtract(tile_, slot_, cut, {}); }

    private:
        ScanTile& tile_;
        size_t slot_;
    };

    ScanLines() = default;
    ScanLines(int axis, int u_count, int v_count);

    int axis() const { return axis_; }
    int u_count() const { return u_count_; }
    int v_count() const { return v_count_; }

    LineView line(int u, int v) const {
        const auto& tile = tiles_[tile_of(u, v)];
        return tile ? tile->line(slot_of(u, v)) : LineView();
    }
    /// The marks of the ends of interval `i` of a line.
    EndMarks marks(int u, int v, size_t i) const {
        const auto& tile = tiles_[tile_of(u, v)];
        return tile ? tile->marks_of(slot_of(u, v), i) : EndMarks();
    }

    /// Write access to a line. Its tile is cloned first if another snapshot shares it.
    Edit edit(int u, int v) { return {edit_tile(tile_of(u, v)), slot_of(u, v)}; }

    /// Tiles are numbered u fastest; null if all lines of the tile are empty.
    size_t tile_count() const { return tiles_.size(); }
    const ScanTile* tile(size_t index) const { return tiles_[index].get(); }
    /// Write access to a tile, cloned first if another snapshot shares it.
    ScanTile& edit_tile(size_t index);
    /// The tile as it is now; it is cloned before the next change.
    std::shared_ptr<ScanTile> share_tile(size_t index) const { return tiles_[index]; }
    /// Puts a shared tile back in its place.
    void put_back(size_t index, std::shared_ptr<ScanTile> tile) { tiles_[index] = std::move(tile); }
    /// Whether a snapshot shares the tile.
    bool is_shared(size_t index) const { return tiles_[index].use_count() > 1; }
    size_t tile_of(int u, int v) const {
        assert(u >= 0 && u < u_count_ && v >= 0 && v < v_count_);
        return static_cast<size_t>(u / tile_side) + static_cast<size_t>(v / tile_side) * u_tiles_;
    }

    /// Whether both objects share the tile that contains the line, so that it need not be compared.
    bool shares_tile(const ScanLines& other, int u, int v) const;

    /// Whether all lines hold the same material; marks are ignored.
    bool operator==(const ScanLines& other) const;

    /// The slot of a line in its tile.
    static constexpr size_t slot_of(int u, int v) {
        return static_cast<size_t>(u % tile_side)
               + static_cast<size_t>(v % tile_side) * static_cast<size_t>(tile_side);
    }

private:
    int axis_ = 0;
    int u_count_ = 0;
    int v_count_ = 0;
    size_t u_tiles_ = 0;
    std::vector<std::shared_ptr<ScanTile>> tiles_;
};

} // namespace core

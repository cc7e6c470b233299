#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/dbm/line_view.h"

namespace core {

/// What made the ends of an interval: 0 for the raw body, else the number of a cut.
struct EndMarks {
    uint32_t lower = 0, upper = 0;
    uint8_t lower_tilt = 0, upper_tilt = 0; // see ScanTile::Marks

    bool operator==(const EndMarks&) const = default;
};

/// The lines of a tile, in layers: layer k holds the k-th interval of every line, all lower ends
/// and all upper ends side by side, so that rows of lines can be worked on in vector lanes.
///
/// Most lines hold one interval or none. Where a line has no k-th one, layer k has (+inf, -inf),
/// which overlaps nothing.
struct ScanTile {
    static constexpr int side = 16;
    static constexpr size_t lines = static_cast<size_t>(side) * side;

    struct alignas(64) Layer {
        std::array<double, lines> lower, upper;
        Layer();
    };
    /// The tilt of an end is 0 where the surface faces along the line or nobody knows, `steepest`
    /// where the line runs along it: steepest * (1 - n^2), n the normal's component on the line.
    struct alignas(64) Marks {
        std::array<uint32_t, lines> lower{}, upper{};
        std::array<uint8_t, lines> lower_tilt{}, upper_tilt{};
    };
    static constexpr int steepest = 255;
    std::vector<Layer> layers = std::vector<Layer>(1);
    std::vector<Marks> marks; // as many as layers, or none as long as all are 0

    LineView line(size_t place) const {
        size_t size = 0;
        while (size < layers.size() && layers[size].lower[place] < layers[size].upper[place])
            ++size;
        constexpr std::ptrdiff_t stride = sizeof(Layer) / sizeof(double);
        return {&layers[0].lower[place], &layers[0].upper[place], stride, size};
    }
    EndMarks marks_of(size_t place, size_t interval) const {
        if (marks.empty()) return {};
        const Marks& m = marks[interval];
        return {m.lower[place], m.upper[place], m.lower_tilt[place], m.upper_tilt[place]};
    }
    /// Makes room for marks, from now on kept for every end.
    void keep_marks() { marks.resize(layers.size()); }
};

/// Puts `matter` on a line in place of what it held; all its ends count as raw.
void set_line(ScanTile& tile, size_t place, const LineView& matter);

/// Takes `cut` out of a line; the ends that it makes, matter's lower one at the upper end of `cut`,
/// get these marks, if the tile keeps marks. Returns the length that was really removed.
double subtract(ScanTile& tile, size_t place, const Interval& cut, const EndMarks& made);

} // namespace core

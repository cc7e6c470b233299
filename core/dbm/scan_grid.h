#pragma once

#include <array>

#include "core/base/vec.h"

namespace core {

/// Where the scan lines of the three families run: spacing h, the lines next to the body's centre
/// half a cell away from it on either side, and no line that misses the body's box.
struct ScanGrid {
    Vec3 centre = Vec3(0.0);
    double spacing = 1.0;               // h, mm
    std::array<int, 3> half_count = {}; // lines on each side of the centre, along X, Y, Z

    bool operator==(const ScanGrid&) const = default;

    int count(int axis) const { return 2 * half_count[static_cast<size_t>(axis)]; }

    /// Position of line `i` along `axis`; any integer, also outside 0 .. count - 1.
    double coordinate(int axis, int i) const {
        return centre[axis] + (i - half_count[static_cast<size_t>(axis)] + 0.5) * spacing;
    }
};

/// The grid of a body with these bounds. `spacing` must be positive and the box not empty.
ScanGrid scan_grid(const Aabb& bounds, double spacing);

/// The lines of such a grid along one axis of a body, in floating point: a mesh size far too small
/// gives more than an integer holds.
inline double lines_across(double size, double spacing) {
    return 2.0 * std::max(1.0, std::ceil(0.5 * size / spacing - 0.5));
}

} // namespace core

#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "core/base/result.h"
#include "core/dbm/scan_lines.h"
#include "core/geom/primitive.h"

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

/// The discrete boundary model of a body: what three families of scan lines meet of it. The ends of
/// the intervals are the boundary points. A copy is a snapshot (see ScanLines).
struct Dbm {
    ScanGrid grid;
    std::array<ScanLines, 3> families; // along X, Y, Z
};

/// The point at `along` on line (u, v) of the family along `axis`.
Vec3 point_on_line(const ScanGrid& grid, int axis, int u, int v, double along);

/// Every boundary point, in a fixed order: family by family, row by row (u fastest), upwards along
/// the line.
std::vector<Vec3> boundary_points(const Dbm& dbm);
size_t point_count(const Dbm& dbm);
size_t line_count(const Dbm& dbm);

constexpr double default_memory_limit = 8.0 * 1024.0 * 1024.0 * 1024.0; // bytes

/// Bytes that the lines of a body with these bounds need, and its points if each line holds one
/// interval.
double memory_estimate(const Aabb& bounds, double spacing);

/// The empty grid of lines for a body with these bounds.
///
/// Errors: a mesh size that is not a positive length; a model that would need more than
///         `memory_limit` bytes, which says what it needs and which mesh size would do. Nothing
///         is allocated before that is known.
Result<Dbm> empty_dbm(const Aabb& bounds, double spacing,
                      double memory_limit = default_memory_limit);

/// The model itself, or the error that no scan line meets the body.
Result<Dbm> checked_not_empty(Dbm dbm);

/// What one line meets of a body: the line along `axis` at (u, v) of the two other axes,
/// cyclically.
using LineFunction = std::function<IntervalList(int axis, double u, double v)>;

/// Scans any body that can answer for a single line.
///
/// Frame:  that of the body; `bounds` must hold it.
/// Errors: as empty_dbm, and no line meets the body.
Result<Dbm> scan_lines_of(const Aabb& bounds, double spacing, const LineFunction& line,
                          double memory_limit = default_memory_limit);

/// Scans a body in closed form. A line that runs in a face counts as if shifted towards +u, +v, as
/// for meshes.
///
/// Errors: as scan_lines_of, and sizes that are not positive lengths.
Result<Dbm> scan(const Primitive& primitive, double spacing,
                 double memory_limit = default_memory_limit);

} // namespace core

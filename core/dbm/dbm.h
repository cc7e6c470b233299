#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "core/base/result.h"
#include "core/dbm/scan_lines.h"
#include "core/geom/primitive.h"

namespace core {

/// Positions of the scan lines of the three families. The lines next to the centre of the body are
/// half a mesh size away from it on either side; no line misses the box of the body.
struct ScanGrid {
    Vec3 centre = Vec3(0.0);
    double spacing = 1.0;               // mesh size h, mm
    std::array<int, 3> half_count = {}; // lines on each side of the centre, along X, Y, Z

    bool operator==(const ScanGrid&) const = default;

    int count(int axis) const { return 2 * half_count[static_cast<size_t>(axis)]; }

    /// Position of line `i` along `axis`, for any integer `i`.
    double coordinate(int axis, int i) const {
        return centre[axis] + (i - half_count[static_cast<size_t>(axis)] + 0.5) * spacing;
    }
};

/// The grid for a body with these bounds. `spacing` must be positive and the box not empty.
ScanGrid scan_grid(const Aabb& bounds, double spacing);

/// The number of lines along one axis of such a grid. Floating point, as a tiny mesh size gives
/// more lines than an integer holds.
inline double lines_across(double size, double spacing) {
    return 2.0 * std::max(1.0, std::ceil(0.5 * size / spacing - 0.5));
}

/// The discrete boundary model of a body: its intersections with three families of scan lines. The
/// ends of the intervals are the boundary points. A copy is a snapshot (see ScanLines).
struct Dbm {
    ScanGrid grid;
    std::array<ScanLines, 3> families; // along X, Y, Z
};

/// A scan line of a body: its family and its indices.
struct LineId {
    int axis = 0, u = 0, v = 0;
};

/// The point at `along` on line (u, v) of the family along `axis`.
Vec3 point_on_line(const ScanGrid& grid, int axis, int u, int v, double along);

/// All boundary points in a fixed order: family by family, row by row (u fastest), upwards along
/// the line.
std::vector<Vec3> boundary_points(const Dbm& dbm);
size_t point_count(const Dbm& dbm);
size_t line_count(const Dbm& dbm);

constexpr double default_memory_limit = 8.0 * 1024.0 * 1024.0 * 1024.0; // bytes

/// Bytes for the lines of a body with these bounds, and for its points if each line holds one
/// interval.
double memory_estimate(const Aabb& bounds, double spacing);

/// The empty grid of lines for a body with these bounds.
///
/// Errors:  a mesh size that is not a positive length; a model that needs more than `memory_limit`
///          bytes: the message states the need and a mesh size that fits. Nothing is allocated
///          before that check.
Result<Dbm> empty_dbm(const Aabb& bounds, double spacing,
                      double memory_limit = default_memory_limit);

/// The model itself, or an error if no scan line meets the body.
Result<Dbm> checked_not_empty(Dbm dbm);

/// The intersection of a body with the line along `axis` at (u, v) of the two next axes,
/// cyclically.
using LineFunction = std::function<IntervalList(int axis, double u, double v)>;

/// Scans a body given by a function for single lines.
///
/// Frame:   the body's; `bounds` must contain it.
/// Errors:  as for empty_dbm; no line meets the body.
Result<Dbm> scan_lines_of(const Aabb& bounds, double spacing, const LineFunction& line,
                          double memory_limit = default_memory_limit);

/// Scans a body in closed form. A line in a face counts as shifted towards +u, +v, as for meshes.
///
/// Errors:  as for scan_lines_of, and sizes that are not positive lengths.
Result<Dbm> scan(const Primitive& primitive, double spacing,
                 double memory_limit = default_memory_limit);

} // namespace core

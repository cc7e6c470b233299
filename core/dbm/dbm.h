#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "core/base/result.h"
#include "core/dbm/scan_grid.h"
#include "core/dbm/scan_lines.h"
#include "core/geom/primitive.h"

namespace core {

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

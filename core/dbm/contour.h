#pragma once

#include "core/dbm/feature_point.h"
#include "core/dbm/surface_point.h"

namespace core {

// Dual contouring of a stock, the steps that every way to go through the cells shares. Nodes are
// where the lines of the three families meet: node (i, j, k) is on the lines i - 1, j - 1, k - 1,
// so that there is a node without lines, outside, all round. Cell (i, j, k) has that node as its
// lowest corner.

/// The lines first .. last of a grid along an axis; none if last < first.
struct IndexRange {
    int first = 0, last = -1;
};

/// The lines across `axis` whose places an interval along it holds, ends included.
IndexRange places_within(const ScanGrid& grid, int axis, const Interval& matter);

/// Where a line passes the surface between a node and the next along `axis`.
struct Crossing {
    LineEnd end;
    double along = 0.0; // between the nodes
    bool found = false; // false: the families differ by rounding, and no end is there
};

Crossing crossing_at(const Dbm& lines, int axis, const std::array<int, 3>& node, bool from_inside);

/// The surface there.
struct CrossedEdge {
    TangentPlane plane;
    std::optional<uint32_t> sweep; // what made it, by its number in the log; empty: raw stock
};

CrossedEdge crossed_edge(const CutModel& model, const Crossing& crossing);

/// The number of the cut that made an end; empty for raw stock.
std::optional<uint32_t> sweep_at(const Dbm& lines, const LineEnd& end);

/// Where the vertices of a cell may stand. `bounds`: of the uncut solid.
Aabb vertex_room(const ScanGrid& grid, const Aabb& bounds, const std::array<int, 3>& cell);

/// How a quad becomes two triangles, (k, k + 1, k + 2) and (k, k + 2, k + 3), and how far a point
/// then is from them, mm.
struct Diagonal {
    size_t from = 0; // k
    double away = 0.0;
};

/// The diagonal that leaves the quad nearer to the point.
Diagonal better_diagonal(const std::array<Vec3, 4>& corners, const Vec3& point);

/// Distance of a point from a triangle.
double distance_to(const Triangle& triangle, const Vec3& point);

} // namespace core

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace core {

struct CutModel;
struct Dbm;
struct Interval;
struct ScanGrid;
struct Triangle;

/// The tangent plane of a surface near one of its points; normals point out of the body.
struct TangentPlane {
    Vec3 position = Vec3(0.0);
    Vec3 normal = Vec3(0.0); // length 1
};

/// The point of a box closest to all given tangent planes of a surface: on a face if they are one
/// plane, on an edge or corner otherwise. In directions that the planes do not determine, the point
/// closest to the mean of the given points.
///
/// Source:  Ju, Losasso, Schaefer, Warren: Dual contouring of Hermite data, 2002.
Vec3 feature_point(std::span<const TangentPlane> points, const Aabb& room);

/// A point on the surface of a stock.
struct SurfacePoint {
    Vec3 point = Vec3(0.0);
    Vec3 normal = Vec3(0.0);       // unit length, out of the stock
    std::optional<uint32_t> block; // that cut it; empty for raw stock
};

/// One end of an interval on a line.
struct LineEnd {
    int axis = 0, u = 0, v = 0;
    size_t interval = 0;
    bool upper = false;
};

/// The surface at the end of an interval.
///
/// Result:  the normal is that of the surface on which the end lies: of the swept volume of the
///          move that cut there, or of the raw stock. On an edge it is that of one of the faces.
/// Cost:    a search of at most 40 steps along the move for each convex piece of the cutter.
SurfacePoint surface_point(const CutModel& model, const LineEnd& end);

// Steps of dual contouring, shared by all traversals of the cells. Nodes are where the lines of the
// three families meet: node (i, j, k) is on the lines i - 1, j - 1, k - 1, so the grid has a border
// of nodes outside of all lines. Node (i, j, k) is the lowest corner of cell (i, j, k).

/// The lines first .. last of a grid along an axis; none if last < first.
struct IndexRange {
    int first = 0, last = -1;
};

/// The lines across `axis` whose positions are within an interval along it, ends included.
IndexRange lines_within(const ScanGrid& grid, int axis, const Interval& matter);

/// Where a line crosses the surface between a node and the next along `axis`.
struct Crossing {
    LineEnd end;
    double along = 0.0; // between the nodes
    bool found = false; // false: the families differ by rounding and there is no end
};

Crossing crossing_at(const Dbm& lines, int axis, const std::array<int, 3>& node, bool from_inside);

/// The surface at a crossing.
struct CrossedEdge {
    TangentPlane plane;
    std::optional<uint32_t> sweep; // number in the log of the cut that made it; empty: raw stock
};

CrossedEdge crossed_edge(const CutModel& model, const Crossing& crossing);

/// The number in the log of the cut that made an end; empty for raw stock.
std::optional<uint32_t> sweep_at(const CutModel& model, const LineEnd& end);

/// Where the vertices of a cell may be. `bounds`: of the uncut solid.
Aabb vertex_room(const ScanGrid& grid, const Aabb& bounds, const std::array<int, 3>& cell);

/// How a quad is split into the triangles (k, k + 1, k + 2) and (k, k + 2, k + 3), and the distance
/// of a point from them, mm.
struct Diagonal {
    size_t from = 0; // k
    double away = 0.0;
};

/// The diagonal that leaves the quad closer to the point.
Diagonal better_diagonal(const std::array<Vec3, 4>& corners, const Vec3& point);

/// Distance of a point from a triangle.
double distance_to(const Triangle& triangle, const Vec3& point);

} // namespace core

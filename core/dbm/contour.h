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

/// The plane on which a surface lies near one of its points: normals are out of the body.
struct TangentPlane {
    Vec3 place = Vec3(0.0);
    Vec3 normal = Vec3(0.0); // length 1
};

/// The point of a box that lies on all the tangent planes of a surface at once, as nearly as
/// possible: on a face if they are one plane, on an edge or corner where they are not; else as near
/// to the middle of the points as the planes leave it.
///
/// Source: Ju, Losasso, Schaefer, Warren: Dual contouring of Hermite data, 2002.
Vec3 feature_point(std::span<const TangentPlane> points, const Aabb& room);

/// A point of a stock's surface.
struct SurfacePoint {
    Vec3 point = Vec3(0.0);
    Vec3 normal = Vec3(0.0);       // of length 1, out of the stock
    std::optional<uint32_t> block; // whose move made it; none for the raw stock
};

/// One end of an interval on a line.
struct LineEnd {
    int axis = 0, u = 0, v = 0;
    size_t interval = 0;
    bool upper = false;
};

/// The surface at the end of an interval.
///
/// Result: the normal is that of the surface which the end lies on: of the swept volume of the move
///         that cut there, or of the raw stock. On an edge it is that of one of the faces.
/// Cost:   a search of at most 40 steps along the move for each convex piece of the cutter.
SurfacePoint surface_point(const CutModel& model, const LineEnd& end);

/// The surface at all ends of one family, in order: row by row, upwards along the line.
std::vector<SurfacePoint> surface_points(const CutModel& model, int axis);

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

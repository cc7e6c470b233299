#pragma once

#include "core/dbm/dbm.h"

namespace core {

struct Mesh;

/// The model of a mesh, and whether shells of the mesh overlap (they are united).
struct MeshScan {
    Dbm dbm;
    bool shells_overlap = false;
};

/// Scans a closed mesh. Material is where the winding number along a line is at least 1, so
/// overlapping shells are united and cavities stay empty.
///
/// Frame:   the mesh's; the grid is centred on its box.
/// Result:  every line is decided exactly, also through edges and corners (it counts as shifted
///          towards +u, +v). Material and gaps thinner than 1e-11 of the coordinates are dropped as
///          rounding.
/// Errors:  as for empty_dbm; no line meets the body; an open or partly inverted mesh.
/// Cost:    proportional to the triangles plus the crossings.
Result<MeshScan> scan_mesh(const Mesh& mesh, double spacing,
                           double memory_limit = default_memory_limit);

/// Scans a closed mesh, for callers that accept overlapping shells.
Result<Dbm> scan(const Mesh& mesh, double spacing, double memory_limit = default_memory_limit);

/// The same with a grid centred on a box that contains the mesh.
Result<Dbm> scan(const Mesh& mesh, const Aabb& box, double spacing,
                 double memory_limit = default_memory_limit);

/// For callers that need one line only: the intersection of a closed mesh with the line along
/// `axis` at (u, v) of the next two axes.
///
/// Errors:  a mesh that is open or inverted along this line.
/// Cost:    every triangle of the mesh.
Result<IntervalList> scan_line(const Mesh& mesh, int axis, double u, double v);

/// Like scan_line(), but there is material wherever the winding number is at least 1, even if the
/// mesh is inverted elsewhere on the line: a fold of the surface must not hide the material before
/// or after it.
IntervalList matter_on_line(const Mesh& mesh, int axis, double u, double v);

} // namespace core

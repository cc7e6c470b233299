#pragma once

#include "core/dbm/dbm.h"

namespace core {

struct Mesh;

/// The model of a mesh, and whether shells of the mesh overlap (their union was taken).
struct MeshScan {
    Dbm dbm;
    bool shells_overlap = false;
};

/// Scans a closed mesh: matter is where the winding number along a line is at least 1, so that
/// overlapping shells are united and cavities stay empty.
///
/// Frame:  that of the mesh; the grid is centred on its box.
/// Result: every line is decided exactly, also one through edges and corners (it counts as shifted
///         towards +u, +v); matter and gaps thinner than 1e-11 of the coordinates are rounding and
///         do not appear.
/// Errors: as empty_dbm; no line meets the body; a mesh that is open or partly inside out.
/// Cost:   time grows with the triangles and the crossings, not with their product.
Result<MeshScan> scan_mesh(const Mesh& mesh, double spacing,
                           double memory_limit = default_memory_limit);

/// The same, for callers who take overlapping shells as they come.
Result<Dbm> scan(const Mesh& mesh, double spacing, double memory_limit = default_memory_limit);

/// What the line along `axis` at (u, v) of the next two axes meets of a closed mesh.
///
/// Errors: a mesh that is open or inside out along this line.
/// Cost:   every triangle of the mesh.
Result<IntervalList> scan_line(const Mesh& mesh, int axis, double u, double v);

/// The same, where the winding number is at least 1, also beside stretches at which the mesh is
/// inside out: a fold of the surface must not hide the matter before or behind it.
IntervalList matter_on_line(const Mesh& mesh, int axis, double u, double v);

} // namespace core

#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include <TopoDS_Shape.hxx>

#include "core/base/result.h"
#include "core/geom/mesh.h"

namespace core::cad {

/// How closely a solid is to be meshed.
struct MeshWish {
    double deviation = 0.01;   // mm
    size_t most_triangles = 0; // of the whole file
};

/// The triangles of a solid.
struct MeshedSolid {
    Mesh mesh;              // one vertex for each point, also on the edges between faces
    double deviation = 0.0; // mm: no surface is farther from the other than this, see README.md
    double gap = 0.0;       // mm: the part of it that the file itself causes
    bool is_proven = true;  // false: part of it was measured, and doubled
};

/// Meshes the faces of a solid with Open CASCADE, then divides triangles until none deviates more
/// than is wanted.
///
/// Errors: an edge without a second face; a face that cannot be meshed; too many triangles. A
///         deviation above the wanted one, due to gaps of the file, is none.
Result<MeshedSolid> mesh_solid(const TopoDS_Shape& solid, const MeshWish& wish);

} // namespace core::cad

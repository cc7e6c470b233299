#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geom/mesh.h"

namespace core {

/// Faces as a file states them: nothing welded, nothing dropped, nothing joined to a surface.
struct PolygonSoup {
    std::vector<Vec3> vertices;
    std::vector<std::vector<uint32_t>> faces;
};

enum class MeshFormat : uint8_t { stl_ascii, stl_binary, obj, off, ply };

/// Reads the faces of a file whose bytes were checked before (mesh_text.h, stl_bytes.h), through
/// OpenMesh's readers.
///
/// Result: single precision, as OpenMesh reads; triangles of an STL that name a corner twice are
///         left out.
/// Errors: indices out of range, coordinates that are not finite, a stream that ends early.
Result<PolygonSoup> read_soup(const std::string& bytes, MeshFormat format);

/// The faces as triangles. A face with a dent is cut along its own corners, never across the dent.
///
/// Errors: a face whose outline crosses itself.
Result<Mesh> triangulated(PolygonSoup soup);

} // namespace core

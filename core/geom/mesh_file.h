#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geom/mesh.h"

namespace core {

/// A solid from a file, and what had to be put right for it to be one.
struct MeshFile {
    Mesh mesh;
    std::vector<std::string> repairs; // one sentence each, without the file's name
};

/// Reads a closed body from an STL (binary or text), OBJ, PLY or OFF file, by its extension.
///
/// Units:  mm, as the file has them; in single precision, as OpenMesh reads them.
/// Result: closed, facing outwards, corners shared (see checked_solid).
/// Errors: name the file and what is wrong with it, with the line, triangle or place where there is
///         one. A mesh is never silently a part of what the file holds.
Result<MeshFile> read_mesh(const std::filesystem::path& path);

} // namespace core

#pragma once

#include <filesystem>
#include <memory>

#include "core/base/result.h"
#include "core/geom/mesh.h"
#include "core/geom/mesh_file.h"

namespace app {

/// Large meshes of this process are kept, so that a check after an edit, or of the next program,
/// does not make them again: the last ones, together at most 3,000,000 triangles, which take about
/// 600 MB. All functions may be called by several threads.

/// The body of a mesh file as core::read_mesh gives it. The file is always read; what was made of
/// the same bytes before is used again.
core::Result<std::shared_ptr<const core::MeshFile>> kept_mesh(const std::filesystem::path& path);

/// core::solid_mesh; the same object for the same triangles.
core::SolidMesh kept_solid(core::Mesh mesh);

} // namespace app

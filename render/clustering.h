#pragma once

#include <span>

#include "render/tinted_mesh.h"

namespace render {

/// About the same surface as that of several meshes, of about `triangles` triangles at most, and of
/// fewer where nothing is lost by that.
///
/// Shape: all that lies in a cell becomes one corner, where the planes of the triangles there meet
///        best: faces stay flat and edges sharp. Cells are large where the surface is flat. What is
///        thinner than the smallest cell may go.
/// Cost:  linear in the triangles.
TintedMesh clustered(std::span<const TriangleMesh* const> parts, size_t triangles);

} // namespace render

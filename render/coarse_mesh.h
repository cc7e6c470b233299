#pragma once

#include <span>

#include "render/triangle_mesh.h"

namespace render {

/// One mesh with about `triangles` triangles at most that shows the visible parts of several, edges
/// and tints included; with fewer if that loses nothing.
TriangleMesh coarse(std::span<const TriangleMesh* const> parts, size_t triangles);

} // namespace render

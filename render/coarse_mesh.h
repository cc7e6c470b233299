#pragma once

#include <span>

#include "render/triangle_mesh.h"

namespace render {

/// A mesh of at most about so many triangles that shows what is to be seen of others, edges and
/// tints included, and fewer where nothing is lost by that.
TriangleMesh coarse(std::span<const TriangleMesh* const> parts, size_t triangles);

} // namespace render

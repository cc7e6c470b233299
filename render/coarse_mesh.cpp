#include "render/coarse_mesh.h"

#include "render/clustering.h"

namespace render {

TriangleMesh coarse(std::span<const TriangleMesh* const> parts, size_t triangles) {
    return shaded(clustered(parts, triangles));
}

} // namespace render

#include "core/geom/box_mesh.h"

namespace core {

Mesh mesh_of(const Aabb& box) {
    Mesh mesh;
    for (unsigned i = 0; i < 8; ++i)
        mesh.vertices.emplace_back(i & 1U ? box.max.x : box.min.x, i & 2U ? box.max.y : box.min.y,
                                   i & 4U ? box.max.z : box.min.z);
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

} // namespace core

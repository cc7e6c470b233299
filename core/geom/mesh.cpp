#include "core/geom/mesh.h"

namespace core {

Aabb Mesh::bounds() const {
    Aabb box;
    for (const Vec3& v : vertices) box.extend(v);
    return box;
}

double signed_volume(const Mesh& mesh) {
    // Tetrahedra against the middle of the box, so that a mesh far from the origin loses no digits.
    const Vec3 origin = mesh.bounds().center();
    double six_volumes = 0.0;
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Triangle t = mesh.triangle(i);
        six_volumes += glm::dot(t.a - origin, glm::cross(t.b - origin, t.c - origin));
    }
    return six_volumes / 6.0;
}

} // namespace core

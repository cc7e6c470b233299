#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/transform.h"
#include "core/geom/mesh.h"

namespace render {

/// A corner of a drawn triangle, as it goes to the graphics card. 16 bytes.
struct MeshVertex {
    glm::vec3 place = glm::vec3(0.0F);
    std::array<int8_t, 3> normal{}; // times 127
    uint8_t tint = 0;               // 0: the body's colour; 1: its second one (stock that was cut)

    bool operator==(const MeshVertex&) const = default;
};

std::array<int8_t, 3> packed_normal(const core::Vec3& normal);
core::Vec3 unpacked_normal(const MeshVertex& vertex);

/// A surface to look at. Counter-clockwise triangles face outwards.
struct TriangleMesh {
    using Corners = std::array<uint32_t, 3>;
    static constexpr size_t stretch = 64;

    std::vector<MeshVertex> vertices;
    std::vector<Corners> triangles;
    std::vector<std::array<glm::vec3, 2>> edges; // lines where the surface has an edge
    core::Aabb bounds;
    std::vector<core::Aabb> boxes; // of `stretch` triangles each, for picking; may be left out
    bool closed = true;            // so that a section of it is a face
};

using SharedMesh = std::shared_ptr<const TriangleMesh>;

/// Edges sharper than this are drawn as edges, radians.
constexpr double crease_angle = 0.5235987755982988; // 30 degrees

/// A mesh with normals: smooth over edges up to `crease`, one per face beyond; these get lines.
TriangleMesh shaded(const core::Mesh& mesh, double crease = crease_angle);

/// The same mesh turned and moved, for bodies made of several.
void append(TriangleMesh& mesh, const TriangleMesh& other, const core::Transform& mesh_from_other);

} // namespace render

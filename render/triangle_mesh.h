#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/vec.h"
#include "core/geom/mesh.h"

namespace render {

/// A vertex of a drawn triangle in the format of the graphics card. 16 bytes.
struct MeshVertex {
    glm::vec3 position = glm::vec3(0.0F);
    std::array<int8_t, 3> normal{}; // times 127
    uint8_t tint = 0;               // 0: the body's colour; 1: its second colour (cut stock)

    bool operator==(const MeshVertex&) const = default;
};

std::array<int8_t, 3> packed_normal(const core::Vec3& normal);
core::Vec3 unpacked_normal(const MeshVertex& vertex);

/// A surface for display. Counter-clockwise triangles face outwards.
struct TriangleMesh {
    using Corners = std::array<uint32_t, 3>;
    static constexpr size_t stretch = 64;

    std::vector<MeshVertex> vertices;
    std::vector<Corners> triangles;
    std::vector<std::array<glm::vec3, 2>> edges; // feature edges
    core::Aabb bounds;
    std::vector<core::Aabb> boxes; // of `stretch` triangles each, for picking; optional
    bool closed = true;            // a section of it can be filled
    std::shared_ptr<const TriangleMesh> rough{}; // with few triangles; null: it has few itself
};

using SharedMesh = std::shared_ptr<const TriangleMesh>;

/// Edges sharper than this are feature edges, radians.
constexpr double crease_angle = 0.5235987755982988; // 30 degrees

/// A mesh with normals: smooth across edges up to `crease`, one per face beyond; sharper edges
/// become feature edges.
TriangleMesh shaded(const core::Mesh& mesh, double crease = crease_angle);

/// Appends a transformed mesh, for bodies made of several.
void append(TriangleMesh& mesh, const TriangleMesh& other, const core::Transform& mesh_from_other);

/// A quad of a surface on a lattice, around one lattice edge: triangles 2 i and 2 i + 1 are quad i.
struct LatticeQuad {
    uint8_t axis = 0;              // of the lattice edge
    std::array<uint8_t, 3> node{}; // start of the edge, below lattice_side
    bool flat = false;             // its corners are centres of cells, in one plane
};

constexpr size_t lattice_side = 34;

/// The same surface with fewer triangles, for display only: adjacent quads of one colour in one
/// plane perpendicular to an axis become rectangles. These overlap their neighbours by a tenth of a
/// cell, so that no gaps are visible where corners do not coincide.
///
/// Cost:    linear in the quads.
TriangleMesh with_large_faces(const TriangleMesh& mesh, std::span<const LatticeQuad> quads);

} // namespace render

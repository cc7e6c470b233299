#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/vec.h"

namespace core {

struct TriangleBvh;

struct Triangle {
    Vec3 a, b, c;

    Aabb bounds() const { return {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)}; }
};

/// A triangle mesh with shared vertices; triangles are counter-clockwise seen from outside.
struct Mesh {
    using Corners = std::array<uint32_t, 3>;

    std::vector<Vec3> vertices; // mm
    std::vector<Corners> triangles;

    Triangle triangle(size_t i) const {
        const Corners& t = triangles[i];
        return {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
    }
    Aabb bounds() const;
};

/// The volume enclosed by a closed mesh; negative if its triangles face inwards.
double signed_volume(const Mesh& mesh);

/// The closed surface of a box, facing outwards.
Mesh mesh_of(const Aabb& box);

/// A closed mesh (see checked_solid) with its search tree.
struct SolidMesh {
    std::shared_ptr<const Mesh> mesh;
    std::shared_ptr<const TriangleBvh> bvh;
    std::vector<Vec3> shell_points; // one vertex of each connected shell
};

SolidMesh solid_mesh(Mesh mesh);

/// The box of its triangles, without traversing them.
Aabb bounds(const SolidMesh& solid);

/// Red, green and blue.
using Colour = std::array<uint8_t, 3>;

/// A binary STL file. The header holds the first 80 characters of `comment`.
///
/// Result:  single precision, as the format requires: a vertex is off by up to 6e-8 of its
///          coordinate.
std::string stl_bytes(const Mesh& mesh, const std::string& comment);

/// A binary PLY file in double precision. `comments` are lines of its header; `colours`, if any,
/// has one entry for each vertex.
std::string ply_bytes(const Mesh& mesh, const std::vector<std::string>& comments,
                      std::span<const Colour> colours = {});

} // namespace core

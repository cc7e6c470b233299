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

/// A triangle mesh: corners shared between triangles, counter-clockwise seen from outside.
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

/// Volume enclosed by a closed mesh; negative when its triangles face inwards.
double signed_volume(const Mesh& mesh);

/// The closed surface of a box, its faces looking outwards.
Mesh mesh_of(const Aabb& box);

/// A closed mesh (see checked_solid), with what searches need of it.
struct SolidMesh {
    std::shared_ptr<const Mesh> mesh;
    std::shared_ptr<const TriangleBvh> bvh;
    std::vector<Vec3> shell_points; // a vertex of each of its connected shells
};

SolidMesh solid_mesh(Mesh mesh);

/// The box of its triangles, which is known.
Aabb bounds(const SolidMesh& solid);

/// Red, green and blue.
using Colour = std::array<uint8_t, 3>;

/// A binary STL file. `comment` stands in its header, 80 characters of it at most.
///
/// Result: single precision, as the format has it: a corner is off by up to 6e-8 of its coordinate.
std::string stl_bytes(const Mesh& mesh, const std::string& comment);

/// A binary PLY file in double precision. `comments` are lines of its header; `colours`, if there
/// are any, one for each vertex.
std::string ply_bytes(const Mesh& mesh, const std::vector<std::string>& comments,
                      std::span<const Colour> colours = {});

} // namespace core

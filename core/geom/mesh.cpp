#include "core/geom/mesh.h"

#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "core/base/union_find.h"
#include "core/geom/triangle_bvh.h"

namespace core {

Aabb Mesh::bounds() const {
    Aabb box;
    for (const Vec3& v : vertices) box.extend(v);
    return box;
}

double signed_volume(const Mesh& mesh) {
    // Tetrahedra with their apex at the middle of the box, so that a mesh far from the origin loses
    // no digits.
    const Vec3 origin = mesh.bounds().center();
    double six_volumes = 0.0;
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Triangle t = mesh.triangle(i);
        six_volumes += glm::dot(t.a - origin, glm::cross(t.b - origin, t.c - origin));
    }
    return six_volumes / 6.0;
}

Mesh mesh_of(const Aabb& box) {
    Mesh mesh;
    for (unsigned i = 0; i < 8; ++i)
        mesh.vertices.emplace_back(i & 1U ? box.max.x : box.min.x, i & 2U ? box.max.y : box.min.y,
                                   i & 4U ? box.max.z : box.min.z);
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

namespace {

/// Appends the bytes of a number, the lowest first.
template <typename T>
void put(std::string& bytes, T value) {
    static_assert(std::endian::native == std::endian::little);
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
}

void put(std::string& bytes, const glm::vec3& v) {
    for (int i = 0; i < 3; ++i) put(bytes, v[i]);
}

/// The first vertex of every connected shell.
std::vector<Vec3> shell_points(const Mesh& mesh) {
    UnionFind shells(mesh.vertices.size());
    for (const Mesh::Corners& t : mesh.triangles) {
        shells.join(t[1], t[0]);
        shells.join(t[2], t[0]);
    }
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const Mesh::Corners& t : mesh.triangles) used[shells.root(t[0])] = true;
    std::vector<Vec3> points;
    for (size_t i = 0; i < used.size(); ++i)
        if (used[i]) points.push_back(mesh.vertices[i]);
    return points;
}

} // namespace

std::string stl_bytes(const Mesh& mesh, const std::string& comment) {
    std::string bytes = comment.substr(0, 80);
    bytes.resize(80, ' ');
    bytes.reserve(84 + 50 * mesh.triangles.size());
    put(bytes, static_cast<uint32_t>(mesh.triangles.size()));
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Triangle t = mesh.triangle(i);
        const Vec3 across = glm::cross(t.b - t.a, t.c - t.a);
        const double area = glm::length(across);
        put(bytes, glm::vec3(area > 0.0 ? across / area : Vec3(0.0)));
        for (const Vec3& corner : {t.a, t.b, t.c}) put(bytes, glm::vec3(corner));
        put(bytes, uint16_t{0});
    }
    return bytes;
}

std::string ply_bytes(const Mesh& mesh, const std::vector<std::string>& comments,
                      std::span<const Colour> colours) {
    std::string bytes = "ply\nformat binary_little_endian 1.0\n";
    for (const std::string& comment : comments) bytes += "comment " + comment + "\n";
    bytes += fmt::format("element vertex {}\n", mesh.vertices.size());
    for (const char axis : {'x', 'y', 'z'}) bytes += fmt::format("property double {}\n", axis);
    if (!colours.empty())
        for (const char* name : {"red", "green", "blue"})
            bytes += fmt::format("property uchar {}\n", name);
    bytes += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                         mesh.triangles.size());
    bytes.reserve(bytes.size() + 27 * mesh.vertices.size() + 13 * mesh.triangles.size());
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
        for (int k = 0; k < 3; ++k) put(bytes, mesh.vertices[i][k]);
        if (!colours.empty())
            for (const uint8_t part : colours[i]) put(bytes, part);
    }
    for (const Mesh::Corners& corners : mesh.triangles) {
        put(bytes, uint8_t{3});
        for (const uint32_t corner : corners) put(bytes, static_cast<int32_t>(corner));
    }
    return bytes;
}

SolidMesh solid_mesh(Mesh mesh) {
    auto bvh = std::make_shared<const TriangleBvh>(build_bvh(mesh));
    std::vector<Vec3> points = shell_points(mesh);
    return {std::make_shared<const Mesh>(std::move(mesh)), std::move(bvh), std::move(points)};
}

Aabb bounds(const SolidMesh& solid) {
    return !solid.bvh || solid.bvh->nodes.empty() ? Aabb{} : solid.bvh->nodes[0].box;
}

} // namespace core

#include "render/triangle_mesh.h"

#include <algorithm>
#include <cmath>

namespace render {
namespace {

using core::Vec3;

/// A corner of a triangle, gathered by the vertex that it stands on.
struct Corner {
    uint32_t vertex, triangle, corner;
};

struct Faces {
    std::vector<Vec3> normals; // of length 1; 0 for triangles without area
    std::vector<Corner> corners;
    std::vector<size_t> first; // of each vertex in corners
};

Faces faces_of(const core::Mesh& mesh) {
    Faces faces;
    faces.first.assign(mesh.vertices.size() + 1, 0);
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const core::Triangle triangle = mesh.triangle(t);
        const Vec3 across = glm::cross(triangle.b - triangle.a, triangle.c - triangle.a);
        const double size = glm::length(across);
        faces.normals.push_back(size > 0.0 ? across / size : Vec3(0.0));
        for (const uint32_t vertex : mesh.triangles[t]) ++faces.first[vertex + 1];
    }
    for (size_t v = 1; v < faces.first.size(); ++v) faces.first[v] += faces.first[v - 1];
    faces.corners.resize(faces.first.back());
    std::vector<size_t> next(faces.first.begin(), faces.first.end() - 1);
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (uint32_t c = 0; c < 3; ++c) {
            const uint32_t vertex = mesh.triangles[t][c];
            faces.corners[next[vertex]++] = {vertex, t, c};
        }
    return faces;
}

double angle_at(const core::Mesh& mesh, const Corner& at) {
    const core::Mesh::Corners& t = mesh.triangles[at.triangle];
    const Vec3 p = mesh.vertices[at.vertex];
    const Vec3 a = mesh.vertices[t[(at.corner + 1) % 3]] - p;
    const Vec3 b = mesh.vertices[t[(at.corner + 2) % 3]] - p;
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// The mean of the normals round a corner that belong to the same smooth stretch.
Vec3 smooth_normal(const core::Mesh& mesh, const Faces& faces, const Corner& at, double limit) {
    const Vec3 own = faces.normals[at.triangle];
    Vec3 sum(0.0);
    for (size_t i = faces.first[at.vertex]; i < faces.first[at.vertex + 1]; ++i) {
        const Corner& other = faces.corners[i];
        const Vec3& normal = faces.normals[other.triangle];
        if (glm::dot(own, normal) >= limit) sum += angle_at(mesh, other) * normal;
    }
    const double size = glm::length(sum);
    return size > 0.0 ? sum / size : own;
}

/// The triangle beyond the edge from corner `at` to the next one; -1 if there is none.
int64_t beyond(const core::Mesh& mesh, const Faces& faces, const Corner& at) {
    const uint32_t to = mesh.triangles[at.triangle][(at.corner + 1) % 3];
    for (size_t i = faces.first[at.vertex]; i < faces.first[at.vertex + 1]; ++i) {
        const Corner& other = faces.corners[i];
        if (mesh.triangles[other.triangle][(other.corner + 2) % 3] == to) return other.triangle;
    }
    return -1;
}

void add_edges(TriangleMesh& made, const core::Mesh& mesh, const Faces& faces, double limit) {
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (uint32_t c = 0; c < 3; ++c) {
            const uint32_t from = mesh.triangles[t][c], to = mesh.triangles[t][(c + 1) % 3];
            const int64_t other = beyond(mesh, faces, {from, t, c});
            if (other < 0) made.closed = false;
            if (other >= 0 && from > to) continue; // drawn from the other side
            if (other >= 0
                && glm::dot(faces.normals[t], faces.normals[static_cast<size_t>(other)]) >= limit)
                continue;
            made.edges.push_back({glm::vec3(mesh.vertices[from]), glm::vec3(mesh.vertices[to])});
        }
}

void make_boxes(TriangleMesh& mesh) {
    mesh.boxes.clear();
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (t % TriangleMesh::stretch == 0) mesh.boxes.emplace_back();
        for (const uint32_t corner : mesh.triangles[t])
            mesh.boxes.back().extend(Vec3(mesh.vertices[corner].place));
    }
}

} // namespace

std::array<int8_t, 3> packed_normal(const Vec3& normal) {
    std::array<int8_t, 3> packed{};
    for (int i = 0; i < 3; ++i)
        packed[static_cast<size_t>(i)] =
            static_cast<int8_t>(std::lround(127.0 * std::clamp(normal[i], -1.0, 1.0)));
    return packed;
}

Vec3 unpacked_normal(const MeshVertex& vertex) {
    return glm::normalize(
        Vec3(vertex.normal[0] / 127.0, vertex.normal[1] / 127.0, vertex.normal[2] / 127.0));
}

TriangleMesh shaded(const core::Mesh& mesh, double crease) {
    TriangleMesh made;
    const double limit = std::cos(crease);
    const Faces faces = faces_of(mesh);
    made.triangles.resize(mesh.triangles.size());
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
        const size_t begin = made.vertices.size();
        for (size_t i = faces.first[v]; i < faces.first[v + 1]; ++i) {
            const Corner& at = faces.corners[i];
            const MeshVertex vertex{glm::vec3(mesh.vertices[v]),
                                    packed_normal(smooth_normal(mesh, faces, at, limit))};
            const auto same = std::find(made.vertices.begin() + static_cast<std::ptrdiff_t>(begin),
                                        made.vertices.end(), vertex);
            made.triangles[at.triangle][at.corner] =
                static_cast<uint32_t>(same - made.vertices.begin());
            if (same == made.vertices.end()) made.vertices.push_back(vertex);
        }
    }
    add_edges(made, mesh, faces, limit);
    made.bounds = mesh.bounds();
    make_boxes(made);
    return made;
}

void append(TriangleMesh& mesh, const TriangleMesh& other, const core::Transform& mesh_from_other) {
    const auto base = static_cast<uint32_t>(mesh.vertices.size());
    const auto moved = [&](const glm::vec3& p) { return glm::vec3(mesh_from_other * Vec3(p)); };
    for (const MeshVertex& v : other.vertices) {
        mesh.vertices.push_back(
            {moved(v.place), packed_normal(mesh_from_other.rotation * unpacked_normal(v)), v.tint});
        mesh.bounds.extend(Vec3(mesh.vertices.back().place));
    }
    for (const TriangleMesh::Corners& t : other.triangles)
        mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
    for (const auto& [a, b] : other.edges) mesh.edges.push_back({moved(a), moved(b)});
    mesh.closed = mesh.closed && other.closed;
    make_boxes(mesh);
}

} // namespace render

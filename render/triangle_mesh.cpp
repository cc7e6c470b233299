#include "render/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/math.h"

namespace render {
namespace {

using core::Vec3;

/// A corner of a triangle, grouped by vertex.
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
    return core::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// The mean of the normals around a corner that belong to the same smooth region.
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
            mesh.boxes.back().extend(Vec3(mesh.vertices[corner].position));
    }
}

} // namespace

std::array<int8_t, 3> packed_normal(const Vec3& normal) {
    std::array<int8_t, 3> packed{};
    for (int i = 0; i < 3; ++i)
        packed[static_cast<size_t>(i)] =
            static_cast<int8_t>(core::round_to_integer(127.0 * std::clamp(normal[i], -1.0, 1.0)));
    return packed;
}

Vec3 unpacked_normal(const MeshVertex& vertex) {
    return glm::normalize(
        Vec3(vertex.normal[0] / 127.0, vertex.normal[1] / 127.0, vertex.normal[2] / 127.0));
}

TriangleMesh shaded(const core::Mesh& mesh, double crease) {
    TriangleMesh made;
    const double limit = core::cos(crease);
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
        mesh.vertices.push_back({moved(v.position),
                                 packed_normal(mesh_from_other.rotation * unpacked_normal(v)),
                                 v.tint});
        mesh.bounds.extend(Vec3(mesh.vertices.back().position));
    }
    for (const TriangleMesh::Corners& t : other.triangles)
        mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
    for (const auto& [a, b] : other.edges) mesh.edges.push_back({moved(a), moved(b)});
    mesh.closed = mesh.closed && other.closed;
    make_boxes(mesh);
}

namespace {

constexpr float overlap = 0.1F; // of a cell
constexpr uint32_t none = std::numeric_limits<uint32_t>::max();
using Layer = std::array<std::array<uint32_t, lattice_side>, lattice_side>; // quads, by v and u

class FaceMerger {
public:
    FaceMerger(const TriangleMesh& mesh, std::span<const LatticeQuad> quads)
        : mesh_(mesh), quads_(quads), taken_(mesh.vertices.size(), none) {}

    TriangleMesh run() {
        made_.edges = mesh_.edges;
        made_.bounds = mesh_.bounds;
        made_.closed = mesh_.closed;
        for (uint32_t quad = 0; quad < quads_.size(); ++quad) {
            if (is_mergeable(quad))
                layers_[quads_[quad].axis][quads_[quad].node[quads_[quad].axis]].push_back(quad);
            else
                keep(quad);
        }
        for (size_t axis = 0; axis < 3; ++axis)
            for (const auto& quads : layers_[axis])
                if (!quads.empty()) merge(axis, quads);
        return std::move(made_);
    }

private:
    const MeshVertex& corner(uint32_t quad, size_t i) const {
        const uint32_t triangle = 2 * quad + (i == 3 ? 1 : 0);
        return mesh_.vertices[mesh_.triangles[triangle][i == 3 ? 2 : i]];
    }

    /// Whether all corners agree on a plane across the axis of the quad.
    bool is_mergeable(uint32_t quad) const {
        if (!quads_[quad].flat) return false;
        const auto axis = static_cast<glm::length_t>(quads_[quad].axis);
        const MeshVertex& first = corner(quad, 0);
        for (size_t a = 0; a < 3; ++a)
            if ((first.normal[a] == 0) != (a != quads_[quad].axis)) return false;
        for (size_t i = 1; i < 4; ++i) {
            const MeshVertex& other = corner(quad, i);
            if (other.position[axis] != first.position[axis] || other.normal != first.normal
                || other.tint != first.tint)
                return false;
        }
        return true;
    }

    bool are_one(uint32_t a, uint32_t b) const {
        const auto axis = static_cast<glm::length_t>(quads_[a].axis);
        const MeshVertex &x = corner(a, 0), &y = corner(b, 0);
        return x.position[axis] == y.position[axis] && x.normal == y.normal && x.tint == y.tint;
    }

    void keep(uint32_t quad) {
        for (uint32_t triangle = 2 * quad; triangle < 2 * quad + 2; ++triangle) {
            TriangleMesh::Corners corners = mesh_.triangles[triangle];
            for (uint32_t& vertex : corners) {
                uint32_t& known = taken_[vertex];
                if (known == none) {
                    known = static_cast<uint32_t>(made_.vertices.size());
                    made_.vertices.push_back(mesh_.vertices[vertex]);
                }
                vertex = known;
            }
            made_.triangles.push_back(corners);
        }
    }

    /// The quads of a layer as rectangles: each as wide as possible, then as high as possible.
    void merge(size_t axis, const std::vector<uint32_t>& quads) {
        const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        Layer layer;
        for (auto& row : layer) row.fill(none);
        for (const uint32_t quad : quads) layer[quads_[quad].node[v]][quads_[quad].node[u]] = quad;
        for (size_t row = 0; row < lattice_side; ++row)
            for (size_t first = 0; first < lattice_side; ++first) {
                const uint32_t quad = layer[row][first];
                if (quad == none) continue;
                const auto is_same = [&](size_t r, size_t c) {
                    return layer[r][c] != none && are_one(layer[r][c], quad);
                };
                size_t end = first + 1, top = row + 1;
                while (end < lattice_side && is_same(row, end)) ++end;
                const auto row_is_same = [&](size_t r) {
                    for (size_t c = first; c < end; ++c)
                        if (!is_same(r, c)) return false;
                    return true;
                };
                while (top < lattice_side && row_is_same(top)) ++top;
                if (end - first == 1 && top - row == 1)
                    keep(quad);
                else
                    add_rectangle(axis, quad, layer[top - 1][end - 1]);
                for (size_t r = row; r < top; ++r)
                    for (size_t c = first; c < end; ++c) layer[r][c] = none;
            }
    }

    /// Adds the rectangle from the quad in its lowest corner to the one in its highest.
    void add_rectangle(size_t axis, uint32_t low, uint32_t high) {
        const auto u = static_cast<glm::length_t>((axis + 1) % 3);
        const auto v = static_cast<glm::length_t>((axis + 2) % 3);
        glm::vec3 min = corner(low, 0).position, max = min, cell_min = min, cell_max = min;
        for (size_t i = 0; i < 4; ++i) {
            cell_min = glm::min(cell_min, corner(low, i).position);
            cell_max = glm::max(cell_max, corner(low, i).position);
            max = glm::max(max, corner(high, i).position);
        }
        const glm::vec3 out = overlap * (cell_max - cell_min);
        min = cell_min - out;
        max += out;
        const bool faces_up = corner(low, 0).normal[axis] > 0;
        const auto first = static_cast<uint32_t>(made_.vertices.size());
        for (const auto& [at_u, at_v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
            MeshVertex vertex = corner(low, 0);
            vertex.position[u] = at_u == 0 ? min[u] : max[u];
            vertex.position[v] = at_v == 0 ? min[v] : max[v];
            made_.vertices.push_back(vertex);
        }
        const uint32_t second = faces_up ? 1 : 3, fourth = 4 - second;
        made_.triangles.push_back({first, first + second, first + 2});
        made_.triangles.push_back({first, first + 2, first + fourth});
    }

    const TriangleMesh& mesh_;
    std::span<const LatticeQuad> quads_;
    std::vector<uint32_t> taken_; // by vertex: its number in the result
    std::array<std::array<std::vector<uint32_t>, lattice_side>, 3> layers_;
    TriangleMesh made_;
};

} // namespace

TriangleMesh with_large_faces(const TriangleMesh& mesh, std::span<const LatticeQuad> quads) {
    return FaceMerger(mesh, quads).run();
}

} // namespace render

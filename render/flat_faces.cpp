#include "render/flat_faces.h"

#include <limits>

namespace render {
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

    /// Whether all corners say the same of a plane across the quad's axis.
    bool is_mergeable(uint32_t quad) const {
        if (!quads_[quad].flat) return false;
        const auto axis = static_cast<glm::length_t>(quads_[quad].axis);
        const MeshVertex& first = corner(quad, 0);
        for (size_t a = 0; a < 3; ++a)
            if ((first.normal[a] == 0) != (a != quads_[quad].axis)) return false;
        for (size_t i = 1; i < 4; ++i) {
            const MeshVertex& other = corner(quad, i);
            if (other.place[axis] != first.place[axis] || other.normal != first.normal
                || other.tint != first.tint)
                return false;
        }
        return true;
    }

    bool are_one(uint32_t a, uint32_t b) const {
        const auto axis = static_cast<glm::length_t>(quads_[a].axis);
        const MeshVertex &x = corner(a, 0), &y = corner(b, 0);
        return x.place[axis] == y.place[axis] && x.normal == y.normal && x.tint == y.tint;
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

    /// The quads of a layer as rectangles: each as wide as it goes, then as high.
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

    /// From the quad in its lowest corner to the one in its highest.
    void add_rectangle(size_t axis, uint32_t low, uint32_t high) {
        const auto u = static_cast<glm::length_t>((axis + 1) % 3);
        const auto v = static_cast<glm::length_t>((axis + 2) % 3);
        glm::vec3 min = corner(low, 0).place, max = min, cell_min = min, cell_max = min;
        for (size_t i = 0; i < 4; ++i) {
            cell_min = glm::min(cell_min, corner(low, i).place);
            cell_max = glm::max(cell_max, corner(low, i).place);
            max = glm::max(max, corner(high, i).place);
        }
        const glm::vec3 out = overlap * (cell_max - cell_min);
        min = cell_min - out;
        max += out;
        const bool faces_up = corner(low, 0).normal[axis] > 0;
        const auto first = static_cast<uint32_t>(made_.vertices.size());
        for (const auto& [at_u, at_v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
            MeshVertex vertex = corner(low, 0);
            vertex.place[u] = at_u == 0 ? min[u] : max[u];
            vertex.place[v] = at_v == 0 ? min[v] : max[v];
            made_.vertices.push_back(vertex);
        }
        const uint32_t second = faces_up ? 1 : 3, fourth = 4 - second;
        made_.triangles.push_back({first, first + second, first + 2});
        made_.triangles.push_back({first, first + 2, first + fourth});
    }

    const TriangleMesh& mesh_;
    std::span<const LatticeQuad> quads_;
    std::vector<uint32_t> taken_; // by vertex: its number in what is made
    std::array<std::array<std::vector<uint32_t>, lattice_side>, 3> layers_;
    TriangleMesh made_;
};

} // namespace

TriangleMesh with_large_faces(const TriangleMesh& mesh, std::span<const LatticeQuad> quads) {
    return FaceMerger(mesh, quads).run();
}

} // namespace render

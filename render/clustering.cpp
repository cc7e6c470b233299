#include "render/clustering.h"

#include <cmath>
#include <unordered_map>

#include "render/cluster_tree.h"

namespace render {
namespace {

using core::Vec3;

constexpr double leaves_to_triangles = 3.0; // as many small cells as that for each triangle wanted
constexpr double first_tolerance = 0.01;    // mm, that a surface may move before anything must go

double area_of(std::span<const TriangleMesh* const> parts) {
    double area = 0.0;
    for (const TriangleMesh* part : parts)
        for (const TriangleMesh::Corners& t : part->triangles) {
            const Vec3 a(part->vertices[t[0]].place), b(part->vertices[t[1]].place),
                c(part->vertices[t[2]].place);
            area += 0.5 * glm::length(glm::cross(b - a, c - a));
        }
    return area;
}

/// A triangle by the cells of its corners.
struct LeafTriangle {
    std::array<uint32_t, 3> leaves;
    Vec3 across; // of the triangle that was there
    uint8_t tint = 0;
};

/// The smallest cells in which the meshes have corners. Frame: moved, so that all is above 0.
class LeafGrid {
public:
    LeafGrid(const Vec3& origin, double width) : origin_(origin), width_(width) {}

    void add(const TriangleMesh& part) {
        std::vector<uint32_t> leaf_of;
        leaf_of.reserve(part.vertices.size());
        for (const MeshVertex& vertex : part.vertices) leaf_of.push_back(leaf(Vec3(vertex.place)));
        for (const TriangleMesh::Corners& t : part.triangles) {
            const Vec3 a(part.vertices[t[0]].place), b(part.vertices[t[1]].place),
                c(part.vertices[t[2]].place);
            const Vec3 across = glm::cross(b - a, c - a);
            const double size = glm::length(across);
            const std::array<uint32_t, 3> corners{leaf_of[t[0]], leaf_of[t[1]], leaf_of[t[2]]};
            if (size > 0.0)
                for (const uint32_t corner : corners)
                    leaves_[corner].planes.add(across / size, a - origin_,
                                               0.5 * size / (width_ * width_));
            if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
                triangles_.push_back({corners, across, part.vertices[t[0]].tint});
        }
    }

    /// The surface with its cells joined.
    TintedMesh mesh(double tolerance) const {
        const Clusters clusters = joined(leaves_, width_, tolerance * tolerance);
        TintedMesh made;
        for (const Vec3& place : clusters.places) made.mesh.vertices.push_back(origin_ + place);
        for (const LeafTriangle& triangle : triangles_) {
            core::Mesh::Corners corners = triangle.leaves;
            for (uint32_t& corner : corners) corner = clusters.of_leaf[corner];
            if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
                continue;
            const auto& places = clusters.places;
            const Vec3 across = glm::cross(places[corners[1]] - places[corners[0]],
                                           places[corners[2]] - places[corners[0]]);
            // What has been turned over lies upon others that have not.
            if (glm::dot(across, triangle.across) <= 0.0) continue;
            made.mesh.triangles.push_back(corners);
            made.tints.push_back(triangle.tint);
        }
        return made;
    }

private:
    uint32_t leaf(const Vec3& place) {
        const Vec3 at = (place - origin_) / width_;
        const CellKey key{uint32_t(at.x), uint32_t(at.y), uint32_t(at.z)};
        const uint64_t hash = uint64_t(key[0]) << 42 | uint64_t(key[1]) << 21 | uint64_t(key[2]);
        const auto [found, is_new] =
            known_.try_emplace(hash, static_cast<uint32_t>(leaves_.size()));
        if (is_new) leaves_.push_back({.key = key});
        ClusterCell& cell = leaves_[found->second];
        cell.sum += place - origin_;
        ++cell.corners;
        return found->second;
    }

    Vec3 origin_;
    double width_;
    std::unordered_map<uint64_t, uint32_t> known_;
    std::vector<ClusterCell> leaves_;
    std::vector<LeafTriangle> triangles_;
};

} // namespace

TintedMesh clustered(std::span<const TriangleMesh* const> parts, size_t triangles) {
    core::Aabb box;
    for (const TriangleMesh* part : parts)
        for (const MeshVertex& vertex : part->vertices) box.extend(Vec3(vertex.place));
    const double area = area_of(parts);
    if (box.empty() || area <= 0.0) return {};
    const Vec3 size = box.max - box.min;
    // Numbers of cells stay below 2 to the 21st.
    const double width =
        std::max(std::sqrt(2.0 * area / (leaves_to_triangles * static_cast<double>(triangles))),
                 1e-6 * std::max({size.x, size.y, size.z}));
    LeafGrid grid(box.min, width);
    for (const TriangleMesh* part : parts) grid.add(*part);
    TintedMesh made = grid.mesh(first_tolerance);
    for (double tolerance = 2.0 * first_tolerance;
         made.mesh.triangles.size() > triangles && tolerance < width; tolerance *= 2.0)
        made = grid.mesh(tolerance);
    return made;
}

} // namespace render

#include "render/coarse_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/base/vec.h"
#include "render/triangle_mesh.h"

namespace render {

/// A mesh with a tint for each triangle.
struct TintedMesh {
    core::Mesh mesh;
    std::vector<uint8_t> tints; // of triangles
};

/// The mesh for display: with normals, and with duplicate corners where tints meet.
TriangleMesh shaded(const TintedMesh& tinted);

/// The approximate surface of several meshes with at most about `triangles` triangles, or fewer if
/// that loses nothing.
///
/// Shape: all corners in a cell become one, at the point that fits the planes of their triangles
/// best, so faces stay flat and edges sharp. Cells are large where the surface is flat. Parts
/// thinner than the smallest cell may vanish. Cost:  linear in the triangles.
TintedMesh clustered(std::span<const TriangleMesh* const> parts, size_t triangles);

TriangleMesh coarse(std::span<const TriangleMesh* const> parts, size_t triangles) {
    return shaded(clustered(parts, triangles));
}

namespace {

/// Assigns tints to the corners of a mesh; corners with two tints are duplicated.
class TintPainter {
public:
    explicit TintPainter(TriangleMesh& mesh)
        : mesh_(mesh), twins_(mesh.vertices.size(), 0), is_painted_(mesh.vertices.size(), false) {}

    /// The corner, or its duplicate, that has this tint.
    uint32_t painted(uint32_t corner, uint8_t tint) {
        if (!is_painted_[corner]) mesh_.vertices[corner].tint = tint;
        is_painted_[corner] = true;
        if (mesh_.vertices[corner].tint == tint) return corner;
        if (twins_[corner] == 0) {
            twins_[corner] = static_cast<uint32_t>(mesh_.vertices.size());
            MeshVertex twin = mesh_.vertices[corner];
            twin.tint = tint;
            mesh_.vertices.push_back(twin);
        }
        return twins_[corner];
    }

private:
    TriangleMesh& mesh_;
    std::vector<uint32_t> twins_; // 0: none
    std::vector<bool> is_painted_;
};

} // namespace

TriangleMesh shaded(const TintedMesh& tinted) {
    TriangleMesh mesh = shaded(tinted.mesh);
    TintPainter painter(mesh);
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        for (uint32_t& corner : mesh.triangles[t])
            corner = painter.painted(corner, tinted.tints[t]);
    return mesh;
}

/// The squared distances of a point from planes, each times a weight, as a function of the point.
///
/// Source: Garland and Heckbert: Surface simplification using quadric error metrics, 1997.
struct PlaneSum {
    core::Mat3 square = core::Mat3(0.0);
    core::Vec3 toward = core::Vec3(0.0);
    double constant = 0.0;

    /// Adds a plane through a point; `normal` has length 1.
    void add(const core::Vec3& normal, const core::Vec3& position, double weight) {
        const double height = glm::dot(normal, position);
        square += weight * glm::outerProduct(normal, normal);
        toward += weight * height * normal;
        constant += weight * height * height;
    }
    void add(const PlaneSum& other) {
        square += other.square;
        toward += other.toward;
        constant += other.constant;
    }

    double at(const core::Vec3& p) const {
        return glm::dot(p, square * p) - 2.0 * glm::dot(toward, p) + constant;
    }
    /// The point of the minimum; in directions that the planes do not determine, near `guess`.
    core::Vec3 least(const core::Vec3& guess) const {
        const double weight = 1e-5 * (square[0][0] + square[1][1] + square[2][2]) + 1e-300;
        return glm::inverse(square + weight * core::Mat3(1.0)) * (toward + weight * guess);
    }
};

/// The indices of a cell of a grid, 0 or more.
using CellKey = std::array<uint32_t, 3>;

/// A cell with the corners of a mesh in it, and the planes of their triangles.
struct ClusterCell {
    CellKey key{};
    PlaneSum planes;
    core::Vec3 sum = core::Vec3(0.0); // of the corners
    size_t corners = 0;

    void add(const ClusterCell& other);
    /// The position that represents all of its corners, in a cell of this width.
    core::Vec3 position(double width) const;
};

/// The final cells of the corners.
struct Clusters {
    std::vector<core::Vec3> positions;
    std::vector<uint32_t> of_leaf; // number of the position of each given cell
};

/// Merges cells by eight into larger ones, repeatedly, as long as one position fits all of their
/// planes. `tolerance`: the maximum of PlaneSum::at there; `width`: that of the given cells.
///
/// Cost:   linear, except for sorting. Source: Schaefer and Warren: Adaptive vertex clustering
/// using octrees, 2003.
Clusters joined(const std::vector<ClusterCell>& leaves, double width, double tolerance);

namespace {

/// A cell of the tree during merging.
struct ClusterNode {
    ClusterCell cell;
    std::vector<uint32_t> leaves;
    bool is_one = true; // one position represents all of it; if not, its contents are final
};

uint64_t order_of(const CellKey& key) {
    return uint64_t(key[0]) << 42 | uint64_t(key[1]) << 21 | uint64_t(key[2]);
}

CellKey parent_of(const CellKey& key) { return {key[0] / 2, key[1] / 2, key[2] / 2}; }

void settle(const ClusterNode& node, double width, Clusters& clusters) {
    if (!node.is_one) return;
    for (const uint32_t leaf : node.leaves)
        clusters.of_leaf[leaf] = static_cast<uint32_t>(clusters.positions.size());
    clusters.positions.push_back(node.cell.position(width));
}

/// Merges the cells of one parent if possible; otherwise they are final.
ClusterNode join(std::span<ClusterNode> children, double width, double tolerance,
                 Clusters& clusters) {
    ClusterNode parent;
    parent.cell.key = parent_of(children.front().cell.key);
    for (const ClusterNode& child : children) {
        parent.is_one = parent.is_one && child.is_one;
        parent.cell.add(child.cell);
    }
    if (parent.is_one && children.size() > 1) {
        const core::Vec3 position = parent.cell.position(2.0 * width);
        parent.is_one = parent.cell.planes.at(position) <= tolerance;
    }
    for (ClusterNode& child : children) {
        if (parent.is_one)
            parent.leaves.insert(parent.leaves.end(), child.leaves.begin(), child.leaves.end());
        else
            settle(child, width, clusters);
    }
    return parent;
}

} // namespace

void ClusterCell::add(const ClusterCell& other) {
    planes.add(other.planes);
    sum += other.sum;
    corners += other.corners;
}

core::Vec3 ClusterCell::position(double width) const {
    const core::Vec3 mean = sum / static_cast<double>(corners);
    const core::Vec3 met = planes.least(mean), off = glm::abs(met - mean);
    return std::max({off.x, off.y, off.z}) <= width ? met : mean;
}

Clusters joined(const std::vector<ClusterCell>& leaves, double width, double tolerance) {
    Clusters clusters;
    clusters.of_leaf.resize(leaves.size());
    std::vector<ClusterNode> nodes;
    for (uint32_t i = 0; i < leaves.size(); ++i) nodes.push_back({leaves[i], {i}});
    while (nodes.size() > 1) {
        std::sort(nodes.begin(), nodes.end(), [](const ClusterNode& a, const ClusterNode& b) {
            return order_of(parent_of(a.cell.key)) < order_of(parent_of(b.cell.key));
        });
        std::vector<ClusterNode> parents;
        for (size_t i = 0; i < nodes.size();) {
            const uint64_t key = order_of(parent_of(nodes[i].cell.key));
            size_t end = i + 1;
            while (end < nodes.size() && order_of(parent_of(nodes[end].cell.key)) == key) ++end;
            parents.push_back(
                join(std::span(nodes).subspan(i, end - i), width, tolerance, clusters));
            i = end;
        }
        nodes = std::move(parents);
        width *= 2.0;
    }
    for (const ClusterNode& node : nodes) settle(node, width, clusters);
    return clusters;
}

namespace {

using core::Vec3;

constexpr double leaves_to_triangles = 3.0; // number of small cells for each desired triangle
constexpr double first_tolerance = 0.01;    // mm; deviation that is always permitted

double area_of(std::span<const TriangleMesh* const> parts) {
    double area = 0.0;
    for (const TriangleMesh* part : parts)
        for (const TriangleMesh::Corners& t : part->triangles) {
            const Vec3 a(part->vertices[t[0]].position), b(part->vertices[t[1]].position),
                c(part->vertices[t[2]].position);
            area += 0.5 * glm::length(glm::cross(b - a, c - a));
        }
    return area;
}

/// A triangle, given by the cells of its corners.
struct LeafTriangle {
    std::array<uint32_t, 3> leaves;
    Vec3 across; // cross product of the sides of the original triangle
    uint8_t tint = 0;
};

/// The smallest cells in which the meshes have corners. Frame: shifted, so that all coordinates are
/// positive.
class LeafGrid {
public:
    LeafGrid(const Vec3& origin, double width) : origin_(origin), width_(width) {}

    void add(const TriangleMesh& part) {
        std::vector<uint32_t> leaf_of;
        leaf_of.reserve(part.vertices.size());
        for (const MeshVertex& vertex : part.vertices)
            leaf_of.push_back(leaf(Vec3(vertex.position)));
        for (const TriangleMesh::Corners& t : part.triangles) {
            const Vec3 a(part.vertices[t[0]].position), b(part.vertices[t[1]].position),
                c(part.vertices[t[2]].position);
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
        for (const Vec3& position : clusters.positions)
            made.mesh.vertices.push_back(origin_ + position);
        for (const LeafTriangle& triangle : triangles_) {
            core::Mesh::Corners corners = triangle.leaves;
            for (uint32_t& corner : corners) corner = clusters.of_leaf[corner];
            if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
                continue;
            const auto& positions = clusters.positions;
            const Vec3 across = glm::cross(positions[corners[1]] - positions[corners[0]],
                                           positions[corners[2]] - positions[corners[0]]);
            // Inverted triangles lie on others that are not inverted.
            if (glm::dot(across, triangle.across) <= 0.0) continue;
            made.mesh.triangles.push_back(corners);
            made.tints.push_back(triangle.tint);
        }
        return made;
    }

private:
    uint32_t leaf(const Vec3& position) {
        const Vec3 at = (position - origin_) / width_;
        const CellKey key{uint32_t(at.x), uint32_t(at.y), uint32_t(at.z)};
        const uint64_t hash = uint64_t(key[0]) << 42 | uint64_t(key[1]) << 21 | uint64_t(key[2]);
        const auto [found, is_new] =
            known_.try_emplace(hash, static_cast<uint32_t>(leaves_.size()));
        if (is_new) leaves_.push_back({.key = key});
        ClusterCell& cell = leaves_[found->second];
        cell.sum += position - origin_;
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
        for (const MeshVertex& vertex : part->vertices) box.extend(Vec3(vertex.position));
    const double area = area_of(parts);
    if (box.empty() || area <= 0.0) return {};
    const Vec3 size = box.max - box.min;
    // Cell indices stay below 2^21.
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

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geom/mesh_sides.h"

namespace core {

/// A largest connected set of coplanar triangles.
struct MeshFacet {
    Vec3 normal = Vec3(0.0);   // outwards, length 1; of the sum of the triangles
    Vec3 centroid = Vec3(0.0); // of its area
    double area = 0.0;         // mm2
    bool curved = false;       // one of the small planes that stand for a curved surface
    uint32_t patch = 0;        // facets of one smooth surface have the same number
};

/// The division of a mesh into facets, and the facets that belong to curved surfaces.
struct MeshFacets {
    std::vector<MeshFacet> facets;
    std::vector<uint32_t> of_triangle; // no_index: a triangle without area or that is not usable
    std::vector<uint32_t> starts;      // the triangles of facet i are listed from starts[i] on
    std::vector<uint32_t> listed;
    double noise = 0.0; // how far a vertex may be from its place, mm

    std::span<const uint32_t> triangles_of(uint32_t facet) const {
        return std::span(listed).subspan(starts[facet], starts[facet + 1] - starts[facet]);
    }
};

/// Neighbours at less than this angle can belong to one curved surface: 12 sides of a circle do.
constexpr double smooth_angle_deg = 32.0;

/// Result:  vertices may deviate by 5e-7 of the largest coordinate, as in STL files with seven
///          digits, or by a unit of the sixth digit if there are no more digits. A facet is curved
///          if at least four follow each other with less than `smooth_angle_deg`, similar areas and
///          similar radii of curvature; three will do if they are equal and more than 20 degrees
///          apart.
/// Cost:    O(n log n), some 0.5 s for a million triangles.
MeshFacets facets_of(const Mesh& mesh, const MeshSides& sides);

} // namespace core

#pragma once

#include <cstdint>
#include <vector>

#include "core/geom/mesh_facets.h"

namespace core {

/// One border of a planar face.
struct FaceBorder {
    std::vector<uint32_t> sides;   // in order, the face on the left
    std::vector<uint32_t> corners; // places in `sides` at which a straight piece starts

    /// The longest side of a straight piece.
    uint32_t side_of_piece(const Mesh& mesh, size_t piece) const;
};

/// The borders of a set of triangles of one plane, the outer ones first.
///
/// `face_of` has the planar face of each triangle; a straight piece ends where the neighbouring
/// face changes.
std::vector<FaceBorder> borders_of(const Mesh& mesh, const MeshSides& sides,
                                   const MeshFacets& facets, uint32_t facet,
                                   const std::vector<uint32_t>& face_of);

/// A circle or arc and the sides that are its chords.
struct RoundBorder {
    FeatureCircle circle;
    std::vector<uint32_t> sides;
};

/// How far a vertex may be from a circle that it is on, mm.
inline double circle_tolerance(double radius, double noise) { return 4.0 * noise + 3e-5 * radius; }

/// Chords that are wider do not form a circle: it needs at least 8.
constexpr double widest_chord = 0.8; // radians

/// The whole circle that a border is, or its arcs.
std::vector<RoundBorder> round_parts(const Mesh& mesh, const FaceBorder& border,
                                     const std::array<Vec3, 2>& axes, const Vec3& normal,
                                     double noise);

} // namespace core

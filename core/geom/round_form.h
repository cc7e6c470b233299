#pragma once

#include <optional>
#include <span>

#include "core/geom/mesh_facets.h"

namespace core {

/// A cylinder or cone about a line: its radius is `radius + slope z` at height z above `origin`.
struct RoundForm {
    Vec3 origin = Vec3(0.0), axis = Vec3(0.0);
    double radius = 0.0, slope = 0.0;
    double sagitta = 0.0; // of its widest chord, as a part of the radius
    double lean = 0.0;    // the component of its normals along the axis

    struct Place {
        double height, radius;
        Vec3 out; // perpendicular to the axis, as long as the radius
    };
    Place place(const Vec3& p) const {
        const double height = glm::dot(p - origin, axis);
        const Vec3 out = p - origin - height * axis;
        return {height, glm::length(out), out};
    }
    double radius_at(double height) const { return radius + slope * height; }
    /// How far a point is outside it.
    double excess(const Vec3& p) const {
        const Place at = place(p);
        return (at.radius - radius_at(at.height)) / std::sqrt(1.0 + slope * slope);
    }
};

/// Sides that deviate less from an axis are along it.
constexpr double along_axis = 1e-2; // radians

/// A direction at right angles to another one of length 1, of length 1.
Vec3 perpendicular(const Vec3& direction);

/// From the start of a side to its end.
inline Vec3 way_along(const Mesh& mesh, uint32_t side) {
    return mesh.vertices[end_of(mesh, side)] - mesh.vertices[start_of(mesh, side)];
}

/// The cylinder or cone that continues a circle over the triangles of these sides, which run along
/// it. Empty if they show none.
std::optional<RoundForm> form_beyond(const Mesh& mesh, const MeshFacets& facets,
                                     const FeatureCircle& circle, std::span<const uint32_t> seeds);

/// The cylinder of which the facets on both sides of a side are chords. Empty if they are no
/// strips.
std::optional<RoundForm> form_of_strips(const Mesh& mesh, const MeshSides& sides,
                                        const MeshFacets& facets, uint32_t side);

/// The cylinder along the sides of triangles that run along a rough form, and through their ends.
std::optional<RoundForm> refined(const Mesh& mesh, double noise, RoundForm form,
                                 std::span<const uint32_t> triangles);

} // namespace core

#pragma once

#include <vector>

#include "core/distance/body_distance.h"
#include "core/geom/primitive.h"
#include "core/geom/profile.h"
#include "render/triangle_mesh.h"

namespace core {
struct Solid;
}

namespace render {

/// Maximum distance of a drawn rounding from the true one, mm.
constexpr double round_sag = 0.02;

/// The surface of a body of revolution: the union of its pieces, without inner faces.
TriangleMesh mesh_of(const core::RevolvedProfile& profile, double sag = round_sag);

/// The surface of a convex shape at its first position.
TriangleMesh mesh_of(const core::ConvexShape& shape, double sag = round_sag);

TriangleMesh mesh_of(const core::ExactBody& body, double sag = round_sag);
TriangleMesh mesh_of(const core::Primitive& primitive, double sag = round_sag);

/// Raw stock.
TriangleMesh mesh_of(const core::Solid& solid, double sag = round_sag);

/// A ball about the origin.
TriangleMesh ball_mesh(double radius, int divisions = 16);

/// A point of the outline of a body of revolution: radius and height.
struct OutlinePoint {
    double r = 0.0, z = 0.0;

    bool operator==(const OutlinePoint&) const = default;
};

/// The outline of the union of a profile's pieces, from the tip up; begins and ends on the axis.
/// Roundings become chords within `sag`. Empty for an empty profile.
std::vector<OutlinePoint> outline_of(const core::RevolvedProfile& profile, double sag);

} // namespace render

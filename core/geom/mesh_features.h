#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/geom/mesh.h"

namespace core {

/// No triangle, side or feature.
constexpr uint32_t no_index = 0xffffffffU;

/// A largest connected set of coplanar triangles.
struct PlanarFace {
    Vec3 normal = Vec3(0.0); // outwards, length 1; exactly along an axis of the frame if it is that
                             // within the precision of the mesh
    Vec3 centroid = Vec3(0.0); // of its area
    double area = 0.0;         // mm2
    /// Corners of its borders, outer border first; the face is on the left seen from outside.
    std::vector<std::vector<Vec3>> loops;
    std::array<Vec3, 2> axes{};   // in the face, at right angles; the first along its longest edge
    Vec3 center = Vec3(0.0);      // of its box along these axes, or of its outer circle
    std::array<double, 2> half{}; // half sizes of the box
};

/// A straight edge at which a planar face ends; edges in one line are one.
struct StraightEdge {
    Vec3 from = Vec3(0.0), to = Vec3(0.0);
    std::array<uint32_t, 2> faces = {no_index, no_index}; // the second is no_index if it is curved
};

/// A vertex of at least three planar faces with independent normals.
struct FeatureCorner {
    Vec3 point = Vec3(0.0);      // the vertex
    Vec3 sharp = Vec3(0.0);      // where the three planes that are the most independent meet
    std::vector<uint32_t> faces; // ascending
};

/// On which side of a circle or round wall the material is.
enum class RoundKind : uint8_t { unknown, bore, boss };

/// A circle, or an arc of at least 90 degrees, along which sides of triangles run.
struct FeatureCircle {
    Vec3 center = Vec3(0.0);
    Vec3 axis = Vec3(0.0); // the normal of its face, or away from its wall
    double radius = 0.0;   // through the vertices, mm: a mesh can stand for a smaller or larger one
    double inscribed_radius = 0.0; // of the circle that its chords touch
    RoundKind kind = RoundKind::unknown;
    bool arc = false;         // a part of a circle only: a fillet, the end of a slot
    double angle = 0.0;       // how much of the circle there is, radians; 2 pi for a whole one
    Vec3 middle = Vec3(0.0);  // its point in the middle of the arc
    uint32_t face = no_index; // a planar face that ends here
    bool outer = false;       // the face fills the circle
    uint32_t wall = no_index; // a round wall that ends here
};

/// A cylinder or cone, or a part of one: the wall of a bore, a boss, a countersink or a fillet.
struct RoundWall {
    Vec3 from = Vec3(0.0), to = Vec3(0.0);     // both ends of its axis, mm
    double radius_from = 0.0, radius_to = 0.0; // through the vertices; equal for a cylinder
    double angle = 0.0;                        // how far it reaches round the axis, radians
    bool full = false;                         // all round
    RoundKind kind = RoundKind::unknown;
    std::array<uint32_t, 2> rims = {no_index, no_index}; // circles at `from` and at `to`
    std::array<bool, 2> open = {false, false}; // no face and no tip closes the bore at this end

    Vec3 axis() const { return glm::normalize(to - from); }
    bool is_cylinder() const { return radius_from == radius_to; }
    bool through() const { return kind == RoundKind::bore && full && open[0] && open[1]; }
};

/// What a machinist can point at on a body.
struct MeshFeatures {
    std::vector<PlanarFace> faces;
    std::vector<StraightEdge> edges;
    std::vector<FeatureCorner> corners;
    std::vector<FeatureCircle> circles;
    std::vector<RoundWall> walls;
    std::vector<uint32_t> face_of; // of each triangle, or no_index; empty for boxes and cylinders
    std::vector<uint32_t> wall_of; // the same
};

/// Finds the features of a body.
///
/// Units:   mm, the frame of the mesh.
/// Result:  ordered by the triangles of the mesh, the same for the same mesh. Triangles that share
///          an edge with more than one other count as open there. A surface of facets at less than
///          32 degrees is curved and has no planar faces. Circles have at least 8 chords.
/// Cost:    O(n log n) and some 150 bytes per triangle; about a second for a million triangles.
MeshFeatures features_of(const Mesh& mesh);

} // namespace core

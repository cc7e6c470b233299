#include "core/geom/shape_features.h"

#include <cmath>
#include <numbers>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/geom/mesh.h"
#include "core/geom/round_form.h"

namespace core {
namespace {

constexpr int shown_chords = 72; // of the loop of a round face

/// The features of a mesh without its triangles, which its users do not see.
MeshFeatures without_triangles(MeshFeatures features) {
    features.face_of.clear();
    features.wall_of.clear();
    return features;
}

PlanarFace round_face(const Vec3& center, const Vec3& normal, double radius) {
    PlanarFace face;
    face.normal = normal;
    face.centroid = face.center = center;
    face.area = std::numbers::pi * radius * radius;
    const Vec3 u = perpendicular(normal);
    face.axes = {u, glm::cross(normal, u)};
    face.half = {radius, radius};
    face.loops.emplace_back();
    for (int i = 0; i < shown_chords; ++i) {
        const auto [s, c] = sin_cos_deg(360.0 * i / shown_chords);
        face.loops[0].push_back(center + radius * (c * face.axes[0] + s * face.axes[1]));
    }
    return face;
}

/// Adds the face and the rim at one end of a cone; nothing at a tip.
void add_end(MeshFeatures& features, size_t end, const Vec3& center, const Vec3& outwards,
             double radius) {
    if (!(radius > 0.0)) return;
    const PlanarFace face = round_face(center, outwards, radius);
    FeatureCircle rim;
    rim.center = center;
    rim.axis = outwards;
    rim.radius = rim.inscribed_radius = radius;
    rim.kind = RoundKind::boss;
    rim.angle = 2.0 * std::numbers::pi;
    rim.middle = face.loops[0][0];
    rim.face = static_cast<uint32_t>(features.faces.size());
    rim.outer = true;
    rim.wall = 0;
    features.walls[0].rims[end] = static_cast<uint32_t>(features.circles.size());
    features.faces.push_back(face);
    features.circles.push_back(rim);
}

} // namespace

MeshFeatures features_of(const Aabb& box) { return without_triangles(features_of(mesh_of(box))); }

MeshFeatures cone_features(const Vec3& from, const Vec3& to, double radius_from, double radius_to) {
    MeshFeatures features;
    RoundWall wall;
    wall.from = from;
    wall.to = to;
    wall.radius_from = radius_from;
    wall.radius_to = radius_to;
    wall.angle = 2.0 * std::numbers::pi;
    wall.full = true;
    wall.kind = RoundKind::boss;
    features.walls.push_back(wall);
    const Vec3 axis = wall.axis();
    add_end(features, 0, from, -axis, radius_from);
    add_end(features, 1, to, axis, radius_to);
    return features;
}

std::optional<Mesh> mesh_of_box(const ConvexShape& shape) {
    if (shape.core != ConvexShape::Core::points || shape.point_count != 8 || shape.margin > 0.0)
        return std::nullopt;
    const auto& p = shape.points;
    double size = 0.0;
    for (const Vec3& point : p) size = std::max(size, glm::length(point));
    for (size_t i = 3; i < 8; ++i) {
        Vec3 expected = p[0];
        for (size_t k = 0; k < 3; ++k)
            if (i >> k & 1U) expected += p[size_t{1} << k] - p[0];
        if (!(glm::distance(p[i], expected) <= 1e-9 * size)) return std::nullopt;
    }
    Mesh mesh = mesh_of(Aabb{Vec3(0.0), Vec3(1.0)});
    for (size_t i = 0; i < 8; ++i) mesh.vertices[i] = p[i] + shape.positions[0].at;
    if (signed_volume(mesh) < 0.0)
        for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

MeshFeatures features_of(const ConvexShape& shape) {
    if (shape.core == ConvexShape::Core::cone) {
        if (shape.margin > 0.0 || !(shape.cone.z1 > shape.cone.z0)) return {};
        const auto at = [&](double z) {
            const Vec3 local(0.0, 0.0, z);
            return shape.positions[0].at + (shape.upright ? local : shape.orientation * local);
        };
        return cone_features(at(shape.cone.z0), at(shape.cone.z1), shape.cone.r0, shape.cone.r1);
    }
    const std::optional<Mesh> box = mesh_of_box(shape);
    return box ? without_triangles(features_of(*box)) : MeshFeatures{};
}

} // namespace core

#include "core/distance/body_distance.h"

#include "core/dbm/solid.h"
#include "core/geom/triangle_bvh.h"

namespace core {
namespace {

Separation overlapping_at(const Vec3& point) {
    return {.lower = 0.0, .upper = 0.0, .point_a = point, .point_b = point, .time_a = 0.0};
}

/// A point of the shape at its first position.
Vec3 inner_point(const ConvexShape& shape) {
    const Vec3 position = shape.positions[0].at;
    if (shape.core == ConvexShape::Core::points) return position + shape.points[0];
    return position + shape.orientation * Vec3(0.0, 0.0, 0.5 * (shape.cone.z0 + shape.cone.z1));
}

/// The shape of B, moving in the frame of A.
ConvexShape moved(const ConvexShape& shape, const Transform& a_from_b, const Vec3& sweep) {
    const Vec3 positions[] = {Vec3(0.0), sweep};
    return swept(posed(shape, a_from_b), positions);
}

Separation turned_round(Separation found) {
    std::swap(found.point_a, found.point_b);
    return found;
}

/// Distance of two meshes. If the surfaces never meet, a mesh that is inside the other at the start
/// stays inside.
Separation between_meshes(const SolidMesh& a, const SolidMesh& b, const Transform& a_from_b,
                          const Vec3& sweep, const SeparationGoal& goal) {
    for (const Vec3& p : b.shell_points)
        if (holds(a, a_from_b * p)) return overlapping_at(a_from_b * p);
    const Transform b_from_a = a_from_b.inverse();
    for (const Vec3& p : a.shell_points)
        if (holds(b, b_from_a * p)) return overlapping_at(p);
    return separation(*a.bvh, *b.bvh, a_from_b, sweep, goal);
}

} // namespace

Aabb bounds(const ExactBody& body) {
    if (const auto* shape = std::get_if<ConvexShape>(&body)) return bounds(*shape);
    return bounds(std::get<SolidMesh>(body));
}

Separation separation(const ConvexShape& shape, const ExactBody& body, const SeparationGoal& goal) {
    if (const auto* convex = std::get_if<ConvexShape>(&body)) {
        const Separation found = separation(shape, *convex, goal);
        if (found.upper < goal.limit) return found;
        Separation none;
        none.lower = std::min(found.lower, goal.limit);
        return none;
    }
    const auto& mesh = std::get<SolidMesh>(body);
    const Separation found = separation(shape, *mesh.bvh, goal);
    if (found.upper == 0.0) return found;
    const Vec3 inner = inner_point(shape);
    return holds(mesh, inner) ? overlapping_at(inner) : found;
}

Separation separation(const ExactBody& a, const ExactBody& b, const Transform& a_from_b,
                      const Vec3& sweep, const SeparationGoal& goal) {
    if (const auto* shape = std::get_if<ConvexShape>(&b))
        return turned_round(separation(moved(*shape, a_from_b, sweep), a, goal));
    const auto& mesh_b = std::get<SolidMesh>(b);
    if (const auto* mesh_a = std::get_if<SolidMesh>(&a))
        return between_meshes(*mesh_a, mesh_b, a_from_b, sweep, goal);
    // A is convex: in the frame of B it moves the opposite way.
    const Transform b_from_a = a_from_b.inverse();
    Separation found = separation(
        moved(std::get<ConvexShape>(a), b_from_a, -(b_from_a.rotation * sweep)), b, goal);
    const Vec3 back = found.time_a * sweep;
    found.point_a = a_from_b * found.point_a + back;
    found.point_b = a_from_b * found.point_b + back;
    return found;
}

} // namespace core

#include <array>

#include "core/distance/body_side.h"

namespace core {
namespace {

/// A convex part made smaller towards the middle of the ball that it holds, so that every point of
/// what is left lies at least `by` inside; by must be less than its depth.
ConvexShape shrunk(const ExactPart& part, double by) {
    ConvexShape shape = std::get<ConvexShape>(part.body);
    const double left = 1.0 - by / part.depth;
    for (size_t i = 0; i < shape.point_count; ++i)
        shape.points[i] = part.centre + left * (shape.points[i] - part.centre);
    shape.cone.r0 *= left;
    shape.cone.r1 *= left;
    shape.cone.z0 = part.centre.z + left * (shape.cone.z0 - part.centre.z);
    shape.cone.z1 = part.centre.z + left * (shape.cone.z1 - part.centre.z);
    shape.margin *= left;
    return shape;
}

/// A point of B that is in the part, if one is nearer than the error to what shrinking by twice as
/// much leaves of it.
std::optional<SharedPoint> shared_with(const ExactPart& a, const BodySide& b,
                                       const BodyMotion& motion, double error) {
    if (!(a.depth > 2.0 * error)) return std::nullopt;
    const std::array part = {ExactPart{shrunk(a, 2.0 * error), {}, 0.0}};
    const SeparationGoal goal{.tolerance = 0.0, .limit = 2.0 * error};
    const Separation found = separation({part}, b, motion, goal).separation;
    if (!(found.upper <= error)) return std::nullopt;
    return SharedPoint{found.point_b, found.time_a};
}

std::optional<SharedPoint> shared_with(const BodySide& a, const ExactPart& b,
                                       const BodyMotion& motion, double error) {
    if (!(b.depth > 2.0 * error)) return std::nullopt;
    const std::array part = {ExactPart{shrunk(b, 2.0 * error), {}, 0.0}};
    const SeparationGoal goal{.tolerance = 0.0, .limit = 2.0 * error};
    const Separation found = separation(a, {part}, motion, goal).separation;
    if (!(found.upper <= error)) return std::nullopt;
    return SharedPoint{found.point_a, found.time_a};
}

double to_surface(const SolidMesh& mesh, const Vec3& p, double limit) {
    return separation(convex_segment(p, p), *mesh.bvh, {0.0, limit}).lower;
}

bool lies_deep(const SolidMesh& mesh, const Vec3& p, double error) {
    return holds(mesh, p) && to_surface(mesh, p, 4.0 * error) >= 4.0 * error;
}

bool lies_in_or_on(const SolidMesh& mesh, const Vec3& p, double error) {
    return holds(mesh, p)
           || separation(convex_segment(p, p), *mesh.bvh, {0.0, 2.0 * error}).upper <= error;
}

/// Calls `prove` with places round the witness until it finds a shared point: at the moments and
/// steps given, from wide ones to those that the error drowns.
template <typename Prove>
std::optional<SharedPoint> any_place(const BodyMotion& motion, const Separation& near,
                                     double widest, double error, const Prove& prove) {
    const bool moves = motion.sweep != Vec3(0.0);
    for (const double later : {0.0, 0.015, -0.015, 0.125, -0.125}) {
        if (later != 0.0 && !moves) break;
        const double time = std::clamp(near.time_a + later, 0.0, 1.0);
        const Transform then = translation(time * motion.sweep) * motion.a_from_b;
        const Vec3 place = near.point_a + 0.5 * (time - near.time_a) * motion.sweep;
        if (const std::optional<Vec3> p = prove(then, place, 0.0)) return SharedPoint{*p, time};
        for (double step = 0.25 * widest; step > 8.0 * error; step *= 0.25)
            if (const std::optional<Vec3> p = prove(then, place, step))
                return SharedPoint{*p, time};
    }
    return std::nullopt;
}

std::optional<SharedPoint> shared_deeply(const SolidMesh& a, const SolidMesh& b,
                                         const BodyMotion& motion, const Separation& near,
                                         double error) {
    const double widest =
        std::min(glm::length(a.mesh->bounds().size()), glm::length(b.mesh->bounds().size()));
    const auto both_hold = [&](const Transform& a_from_b, const Vec3& p) {
        const Vec3 in_b = a_from_b.inverse() * p;
        return (lies_deep(a, p, error) && lies_in_or_on(b, in_b, error))
               || (lies_deep(b, in_b, error) && lies_in_or_on(a, p, error));
    };
    const auto prove = [&](const Transform& then, const Vec3& place,
                           double step) -> std::optional<Vec3> {
        for (int i = 0; i < 27; ++i) {
            const Vec3 p = place + step * Vec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            if ((i == 13) == (step == 0.0) && both_hold(then, p)) return p;
        }
        return std::nullopt;
    };
    return any_place(motion, near, widest, error, prove);
}

/// A point of a stretch of matter that lies deep in a mesh; the stretch is in the frame of B.
std::optional<SharedPoint> shared_deeply(const SolidMesh& a, const Aabb& stretch,
                                         const BodyMotion& motion, const Separation& near,
                                         double error) {
    const Vec3 along = stretch.size();
    const double length = glm::length(along);
    const auto prove = [&](const Transform& then, const Vec3& place,
                           double step) -> std::optional<Vec3> {
        const double at = glm::dot(then.inverse() * place - stretch.min, along) / length;
        for (const double sign : {-1.0, 1.0}) {
            const Vec3 p =
                then * (stretch.min + std::clamp(at + sign * step, 0.0, length) * (along / length));
            if (lies_deep(a, p, error)) return p;
        }
        return std::nullopt;
    };
    return any_place(motion, near, 4.0 * length, error, prove);
}

bool is_convex(const ExactPart& part) { return std::holds_alternative<ConvexShape>(part.body); }

BodyMotion seen_from_b(const BodyMotion& motion) {
    const Transform b_from_a = motion.a_from_b.inverse();
    return {b_from_a, -(b_from_a.rotation * motion.sweep)};
}

} // namespace

std::optional<SharedPoint> certainly_shared(const BodySide& a, const BodySide& b,
                                            const BodyMotion& motion, const SideSeparation& near,
                                            double error) {
    std::optional<SharedPoint> shared;
    if (a.is_exact() && is_convex(a.parts[near.part_a]))
        shared = shared_with(a.parts[near.part_a], b, motion, error);
    if (!shared && b.is_exact() && is_convex(b.parts[near.part_b]))
        shared = shared_with(a, b.parts[near.part_b], motion, error);
    if (shared) return shared;
    const auto mesh_of = [](const BodySide& side, size_t part) {
        return side.is_exact() ? std::get_if<SolidMesh>(&side.parts[part].body) : nullptr;
    };
    const SolidMesh* mesh_a = mesh_of(a, near.part_a);
    const SolidMesh* mesh_b = mesh_of(b, near.part_b);
    if (mesh_a && mesh_b) return shared_deeply(*mesh_a, *mesh_b, motion, near.separation, error);
    if (mesh_a && !b.is_exact())
        return shared_deeply(*mesh_a, b.boxes->boxes[near.part_b], motion, near.separation, error);
    if (!mesh_b || a.is_exact()) return std::nullopt;
    const BodyMotion back = seen_from_b(motion);
    Separation turned = near.separation;
    turned.point_a = motion.a_from_b.inverse()
                     * (near.separation.point_b - near.separation.time_a * motion.sweep);
    shared = shared_deeply(*mesh_b, a.boxes->boxes[near.part_a], back, turned, error);
    if (shared) shared->point = motion.a_from_b * shared->point + shared->time * motion.sweep;
    return shared;
}

} // namespace core

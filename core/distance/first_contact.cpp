#include "core/distance/first_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/distance/facing_triangles.h"
#include "core/geom/shape_features.h"

namespace core {
namespace {

constexpr size_t nothing = std::numeric_limits<size_t>::max(); // is touched
constexpr int most_advances = 200;
constexpr double touching_gap = 1e-9;   // mm
constexpr double certain_normal = 1e-6; // mm: the direction between nearer points is rounding
constexpr double least_approach = 1e-9; // of a plane: the motion is along it

/// The shape, less wide by `by` on all sides: for what is at its widest.
ConvexShape slimmed(ConvexShape shape, double by) {
    if (shape.margin >= by) {
        shape.margin -= by;
        return shape;
    }
    if (shape.core == ConvexShape::Core::cone) {
        shape.cone.r0 = std::max(shape.cone.r0 - by, 0.0);
        shape.cone.r1 = std::max(shape.cone.r1 - by, 0.0);
        const double length = shape.cone.z1 - shape.cone.z0, end = std::min(by, 0.25 * length);
        shape.cone.z0 += end;
        shape.cone.z1 -= end;
        return shape;
    }
    Aabb box;
    Vec3 middle(0.0);
    for (size_t i = 0; i < shape.point_count; ++i) {
        box.extend(shape.points[i]);
        middle += shape.points[i] / static_cast<double>(shape.point_count);
    }
    const double size = glm::length(box.size());
    const double part = size > 2.0 * by ? by / size : 0.5;
    for (size_t i = 0; i < shape.point_count; ++i)
        shape.points[i] += part * (middle - shape.points[i]);
    return shape;
}

/// The greatest product of a point of the shape with a direction of length 1.
double reach_along(const ConvexShape& shape, const Vec3& direction) {
    return glm::dot(support(shape, direction).point, direction) + shape.margin;
}

/// A convex shape and the slimmer one that is used to find contacts: what only grazes it passes.
struct SlimShape {
    ConvexShape full, slim;

    /// How much less the slim one reaches in a direction.
    double less_along(const Vec3& direction) const {
        return reach_along(full, direction) - reach_along(slim, direction);
    }
};

/// Where a convex shape that moves along Z meets another one.
struct Meeting {
    double way = 0.0;
    Vec3 normal = Vec3(0.0); // of the plane between them shortly before
    bool at_start = false;
};

/// Moves a convex shape from the height `way` on. It advances by the time in which a plane between
/// the shapes would be reached, so it never goes too far.
std::optional<Meeting> meeting(ConvexShape moving, const ConvexShape& fixed, double way,
                               double limit) {
    const Vec3 start = moving.positions[0].at;
    Meeting found{way};
    for (int i = 0; i < most_advances && found.way <= limit; ++i) {
        moving.positions[0].at = start + Vec3(0.0, 0.0, found.way);
        const Separation apart = separation(moving, fixed, {.tolerance = 0.1 * touching_gap});
        found.at_start = i == 0;
        if (apart.upper <= touching_gap) return found;
        const Vec3 normal = glm::normalize(apart.point_b - apart.point_a);
        const double gap = -reach_along(fixed, -normal) - reach_along(moving, normal);
        if (gap > 0.0 && normal.z <= 0.0) return std::nullopt; // the plane is never reached
        if (apart.upper > certain_normal) found.normal = normal;
        const double advance = normal.z > 0.0 ? gap / normal.z : 0.0;
        if (advance <= touching_gap && apart.lower <= touching_gap) return found;
        found.way += std::max(advance, apart.lower);
    }
    if (found.way > limit) return std::nullopt;
    return found;
}

/// How far a convex shape can move along Z until it touches another one, which may be below it:
/// then it is negative. Convex shapes meet in one interval of the line only.
///
/// The slim shapes decide whether they meet, the full ones where, unless these graze before.
std::optional<double> way_along_z(const SlimShape& moving, const SlimShape& fixed, double limit) {
    const Vec3 up(0.0, 0.0, 1.0);
    const double below = -reach_along(fixed.slim, -up) - reach_along(moving.slim, up) - 1.0;
    const auto slim = meeting(moving.slim, fixed.slim, below, limit + 1.0);
    if (!slim || !(slim->normal.z > 0.0)) return std::nullopt;
    const double back =
        (moving.less_along(slim->normal) + fixed.less_along(-slim->normal)) / slim->normal.z;
    const double start = slim->way - 2.0 * back - certain_normal;
    const auto full = meeting(moving.full, fixed.full, start, slim->way);
    if (full && !full->at_start) return full->way;
    return slim->way - back;
}

/// A body in the frame in which the motion is along Z: triangles, or else a shape with a curved
/// surface.
struct TravelBody {
    std::optional<ConvexShape> curved;
    const Mesh* mesh = nullptr; // if it is not curved
    std::optional<Mesh> box;    // the mesh, if the body is one
    Transform travel_from_body;

    std::vector<Triangle> facing(bool up, double graze) const {
        return facing_triangles(box ? *box : *mesh, travel_from_body, up, graze);
    }
};

TravelBody travel_body(const ExactBody& body, const Transform& travel_from_body) {
    TravelBody result;
    result.travel_from_body = travel_from_body;
    if (const auto* shape = std::get_if<ConvexShape>(&body)) {
        result.box = mesh_of_box(*shape);
        if (!result.box) result.curved = posed(*shape, travel_from_body);
    } else {
        result.mesh = std::get<SolidMesh>(body).mesh.get();
        if (!result.mesh) result.box = Mesh{};
    }
    return result;
}

/// Searches the least travel to any of the supports.
class ContactSearch {
public:
    ContactSearch(const ExactBody& body, const Transform& travel_from_body, const ContactGoal& goal)
        : moving_(travel_body(body, travel_from_body)), goal_(goal), best_{goal.limit, nothing} {
        if (!moving_.curved) front_ = moving_.facing(true, goal.graze);
    }

    void add(const ExactBody& body, const Transform& travel_from_body, size_t number) {
        const TravelBody fixed = travel_body(body, travel_from_body);
        number_ = number;
        if (moving_.curved && fixed.curved) {
            offer(way_along_z({*moving_.curved, slimmed(*moving_.curved, goal_.graze)},
                              {*fixed.curved, *fixed.curved}, best_.travel));
        } else if (moving_.curved) {
            curved_to_triangles(fixed.facing(false, goal_.graze));
        } else if (fixed.curved) {
            triangles_to_curved(*fixed.curved);
        } else {
            triangles_to_triangles(fixed.facing(false, goal_.graze));
        }
    }

    /// Takes over a way that is not below a contact that has been found.
    void offer(std::optional<double> way) {
        if (!way || *way < -goal_.sunk) return;
        const double travel = std::max(*way, 0.0);
        if (best_.support == nothing ? travel > best_.travel : travel >= best_.travel) return;
        best_ = {travel, number_};
    }

    void set_number(size_t number) { number_ = number; }

    std::optional<FirstContact> result() const {
        if (best_.support == nothing) return std::nullopt;
        return best_;
    }

private:
    /// Gaps from here on do not matter; a little more than the best, so that a limit counts.
    double limit() const {
        return best_.support == nothing ? best_.travel + goal_.graze : best_.travel;
    }

    void triangles_to_triangles(std::vector<Triangle> back) {
        const TriangleStack stack(std::move(back));
        for (const Triangle& moving : front_)
            stack.for_each_above(
                moving.bounds(), goal_.sunk, [&] { return limit(); },
                [&](const Triangle& fixed) {
                    offer(way_between(moving, fixed, goal_.graze, goal_.sunk));
                });
    }

    void curved_to_triangles(std::vector<Triangle> back) {
        const SlimShape shape{*moving_.curved, slimmed(*moving_.curved, goal_.graze)};
        const TriangleStack stack(std::move(back));
        stack.for_each_above(
            bounds(shape.full), goal_.sunk, [&] { return limit(); },
            [&](const Triangle& fixed) {
                const ConvexShape triangle = convex(fixed);
                offer(way_along_z(shape, {triangle, triangle}, best_.travel));
            });
    }

    void triangles_to_curved(const ConvexShape& fixed) {
        const SlimShape shape{fixed, slimmed(fixed, goal_.graze)};
        const Aabb box = bounds(fixed);
        for (const Triangle& moving : front_) {
            const Aabb own = moving.bounds();
            if (own.min.x > box.max.x || own.max.x < box.min.x || own.min.y > box.max.y
                || own.max.y < box.min.y || box.min.z - own.max.z >= limit())
                continue;
            const ConvexShape triangle = convex(moving);
            offer(way_along_z({triangle, triangle}, shape, best_.travel));
        }
    }

    TravelBody moving_;
    std::vector<Triangle> front_;
    ContactGoal goal_;
    FirstContact best_;
    size_t number_ = 0;
};

/// The frame in which the motion is along Z, with its origin at the body.
Transform travel_from_machine(const Vec3& direction, const Vec3& origin) {
    const Vec3 a = glm::abs(direction);
    const Vec3 aside = a.x <= a.y && a.x <= a.z ? Vec3(1, 0, 0)
                       : a.y <= a.z             ? Vec3(0, 1, 0)
                                                : Vec3(0, 0, 1);
    const Vec3 u = glm::normalize(aside - glm::dot(aside, direction) * direction);
    const Mat3 back = glm::transpose(Mat3(u, glm::cross(direction, u), direction));
    return {back, -(back * origin)};
}

/// How far a body can move until it is in a plane.
std::optional<double> way_to_plane(const ExactBody& body, const Transform& pose,
                                   const Vec3& direction, const FacePlane& plane) {
    const double approach = -glm::dot(direction, plane.normal);
    if (approach <= least_approach) return std::nullopt;
    const double height =
        extent_along(body, pose, plane.normal).from - glm::dot(plane.point, plane.normal);
    return std::max(height / approach, 0.0);
}

} // namespace

std::optional<FirstContact> first_contact(const ExactBody& body, const Transform& pose,
                                          const Vec3& direction,
                                          std::span<const PlacedBody> supports,
                                          std::span<const FacePlane> planes,
                                          const ContactGoal& goal) {
    const Vec3 along = glm::normalize(direction);
    if (!is_finite(along)) return std::nullopt;
    const Transform travel = travel_from_machine(along, pose.translation);
    ContactSearch search(body, travel * pose, goal);
    for (size_t i = 0; i < supports.size(); ++i)
        search.add(*supports[i].body, travel * supports[i].pose, i);
    for (size_t i = 0; i < planes.size(); ++i) {
        search.set_number(supports.size() + i);
        search.offer(way_to_plane(body, pose, along, planes[i]));
    }
    return search.result();
}

BodyExtent extent_along(const ExactBody& body, const Transform& pose, const Vec3& direction) {
    if (const auto* mesh = std::get_if<SolidMesh>(&body))
        return mesh->mesh ? extent_along(*mesh->mesh, pose, direction) : BodyExtent{};
    const auto& shape = std::get<ConvexShape>(body);
    const Vec3 own = direction * pose.rotation;
    const double origin = glm::dot(pose.translation, direction);
    return {origin - reach_along(shape, -own), origin + reach_along(shape, own)};
}

} // namespace core

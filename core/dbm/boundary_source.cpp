#include "core/dbm/boundary_source.h"

#include <algorithm>
#include <cmath>

namespace core {
namespace {

constexpr double on_surface = 1e-6; // mm

/// How far from the surface, on the side of the matter, the direction to it is taken, mm.
constexpr double step_inside = 1e-3;

Vec3 unit(int axis, double sign) {
    Vec3 direction(0.0);
    direction[axis] = sign;
    return direction;
}

struct NearestFace {
    double distance = infinity;
    Vec3 normal = Vec3(0.0);

    void offer(double away, const Vec3& direction) {
        if (away < distance) *this = {away, direction};
    }
    std::optional<Vec3> result() const {
        return distance <= on_surface ? std::optional(normal) : std::nullopt;
    }
};

std::optional<Vec3> normal_of(const SolidBox& solid, const Vec3& place, int axis) {
    NearestFace nearest;
    for (int k = 0; k < 3; ++k) {
        const int i = (axis + k) % 3; // where faces meet, that which the line passes
        nearest.offer(std::abs(place[i] - solid.box.min[i]), unit(i, -1.0));
        nearest.offer(std::abs(place[i] - solid.box.max[i]), unit(i, 1.0));
    }
    return nearest.result();
}

std::optional<Vec3> normal_of(const SolidCylinder& solid, const Vec3& place, int) {
    NearestFace nearest;
    const double height = place[solid.axis] - solid.base[solid.axis];
    nearest.offer(std::abs(height), unit(solid.axis, -1.0));
    nearest.offer(std::abs(height - solid.height), unit(solid.axis, 1.0));
    Vec3 out = place - solid.base;
    out[solid.axis] = 0.0;
    const double radius = glm::length(out);
    if (radius > 0.0) nearest.offer(std::abs(radius - solid.radius), out / radius);
    return nearest.result();
}

std::optional<Vec3> normal_of(const SolidMesh& solid, const Vec3& place, int) {
    NearestFace nearest;
    for (const uint32_t id : triangles_in(*solid.bvh, Aabb{place, place}.grown(on_surface))) {
        const Triangle t = solid.mesh->triangle(id);
        const Vec3 across = glm::cross(t.b - t.a, t.c - t.a);
        const double area = glm::length(across);
        if (area > 0.0)
            nearest.offer(std::abs(glm::dot(place - t.a, across)) / area, across / area);
    }
    return nearest.result();
}

/// The direction from a point outside of a sweep to the nearest point of it, and how far that is.
NearestFace towards(const CutterSweep& sweep, const Vec3& place) {
    NearestFace nearest;
    const Vec3 places[] = {sweep.from, sweep.to};
    const ConvexShape point = convex_segment(place, place);
    for (const Cutter::Piece& piece : sweep.cutter->pieces) {
        for (const ProfileElement& element : piece.around.elements) {
            const ConvexShape body = posed(convex(element), {sweep.orientation, Vec3(0.0)});
            const Separation gap = separation(swept(body, places), point,
                                              {.tolerance = 1e-11, .limit = nearest.distance});
            if (gap.found() && gap.upper > 0.0)
                nearest.offer(gap.upper, (gap.point_a - gap.point_b) / gap.upper);
        }
    }
    return nearest;
}

bool ends_at(const CutterSweep& sweep, const BoundaryPoint& point, double u, double v) {
    for (const Cutter::Piece& piece : sweep.cutter->pieces) {
        const auto gone = line_interval(piece.around, sweep, point.axis, u, v);
        if (gone && (point.upper ? gone->lower : gone->upper) == point.along) return true;
    }
    return false;
}

} // namespace

std::optional<Vec3> raw_normal(const Solid& solid, const Vec3& place, int axis) {
    return std::visit([&](const auto& shape) { return normal_of(shape, place, axis); },
                      solid.shape);
}

const std::vector<uint32_t>& BoundarySources::near(const Vec3& place) {
    const double size = 4.0 * model_.lines.grid.spacing;
    uint64_t key = 0;
    Aabb box;
    for (int i = 0; i < 3; ++i) {
        const double cell = std::floor((place[i] - model_.outer_box.min[i]) / size);
        key = key << 21U | (static_cast<uint64_t>(static_cast<int64_t>(cell) + 1) & 0x1fffffU);
        box.min[i] = model_.outer_box.min[i] + cell * size;
        box.max[i] = box.min[i] + size;
    }
    if (near_.size() > 4096) near_.clear();
    const auto [at, is_new] = near_.try_emplace(key);
    if (is_new) at->second = sweeps_near(model_, box.grown(step_inside));
    return at->second;
}

std::optional<uint32_t> BoundarySources::sweep_that_ends_at(const BoundaryPoint& point,
                                                            const Vec3& place) {
    const std::vector<uint32_t>& numbers = near(place);
    const Aabb here = Aabb{place, place}.grown(step_inside);
    const double u = place[u_axis(point.axis)], v = place[v_axis(point.axis)];
    for (auto number = numbers.rbegin(); number != numbers.rend(); ++number) {
        const LoggedSweep& logged = model_.log[*number];
        if (overlaps(logged.box, here) && ends_at(logged.sweep, point, u, v)) return *number;
    }
    return std::nullopt;
}

BoundarySource BoundarySources::at(const BoundaryPoint& point) {
    const Vec3 place = point_on_line(model_.lines.grid, point.axis, point.u, point.v, point.along);
    const Vec3 out = unit(point.axis, point.upper ? 1.0 : -1.0);
    if (const auto raw = raw_normal(model_.solid, place, point.axis)) return {*raw, std::nullopt};
    const Vec3 inside = place - step_inside * out;
    BoundarySource source{out, sweep_that_ends_at(point, place)};
    NearestFace nearest;
    if (source.sweep) {
        nearest = towards(model_.log[*source.sweep].sweep, inside);
    } else {
        const Aabb here = Aabb{place, place}.grown(step_inside);
        for (const uint32_t number : near(place)) {
            if (!overlaps(model_.log[number].box, here)) continue;
            const NearestFace face = towards(model_.log[number].sweep, inside);
            // Where several cut equally deep, the last one has the say.
            if (!(face.distance <= std::min(nearest.distance, 2.0 * step_inside))) continue;
            nearest = face;
            source.sweep = number;
        }
    }
    if (nearest.distance < infinity) source.normal = nearest.normal;
    return source;
}

} // namespace core

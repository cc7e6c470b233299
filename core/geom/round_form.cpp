#include "core/geom/round_form.h"

#include <algorithm>
#include <cmath>

#include "core/geom/circle_fit.h"
#include "core/geom/face_borders.h"

namespace core {
namespace {

/// The width of a facet across a side at its border, if it is a strip between two parallels.
std::optional<double> strip_width(const Mesh& mesh, const MeshFacets& facets, uint32_t facet,
                                  const Vec3& at, const Vec3& across) {
    double width = 0.0;
    for (const uint32_t t : facets.triangles_of(facet))
        for (const uint32_t v : mesh.triangles[t])
            width = std::max(width, glm::dot(mesh.vertices[v] - at, across));
    const double tolerance = 4.0 * facets.noise + 1e-3 * width;
    for (const uint32_t t : facets.triangles_of(facet))
        for (const uint32_t v : mesh.triangles[t]) {
            const double x = glm::dot(mesh.vertices[v] - at, across);
            if (std::min(std::abs(x), std::abs(x - width)) > tolerance) return std::nullopt;
        }
    return width;
}

template <typename Act>
void for_each_side(std::span<const uint32_t> triangles, const Act& act) {
    for (const uint32_t t : triangles)
        for (uint32_t side = 3 * t; side < 3 * t + 3; ++side) act(side);
}

} // namespace

Vec3 perpendicular(const Vec3& direction) {
    const Vec3 a = glm::abs(direction);
    const Vec3 least = a.x <= a.y && a.x <= a.z ? Vec3(1, 0, 0)
                       : a.y <= a.z             ? Vec3(0, 1, 0)
                                                : Vec3(0, 0, 1);
    return glm::normalize(glm::cross(direction, least));
}

std::optional<RoundForm> form_beyond(const Mesh& mesh, const MeshFacets& facets,
                                     const FeatureCircle& circle, std::span<const uint32_t> seeds) {
    RoundForm form{circle.center, circle.axis, circle.radius, 0.0, 0.0, 0.0};
    form.sagitta = 1.0 - circle.inscribed_radius / circle.radius;
    const double tolerance = circle_tolerance(circle.radius, facets.noise);
    std::vector<double> slopes;
    size_t upright = 0;
    for (const uint32_t side : seeds) {
        const Vec3& tip = mesh.vertices[end_of(mesh, MeshSides::next(side))];
        const auto at = form.place(tip);
        if (std::abs(at.height) <= tolerance) continue; // a sliver along the circle
        slopes.push_back((at.radius - circle.radius) / at.height);
        const double off = at.radius - circle.radius;
        if (off <= tolerance && off >= -tolerance - form.sagitta * circle.radius) ++upright;
    }
    if (slopes.empty()) return std::nullopt;
    const bool cylinder = 2 * upright >= slopes.size();
    if (!cylinder) {
        std::nth_element(slopes.begin(), slopes.begin() + slopes.size() / 2, slopes.end());
        form.slope = slopes[slopes.size() / 2];
    }
    form.lean = glm::dot(facets.facets[facets.of_triangle[seeds[0] / 3]].normal, form.axis);
    if (cylinder && std::abs(form.lean) > 0.5) return std::nullopt;
    return form;
}

std::optional<RoundForm> form_of_strips(const Mesh& mesh, const MeshSides& sides,
                                        const MeshFacets& facets, uint32_t side) {
    const uint32_t i = facets.of_triangle[side / 3];
    const uint32_t k = facets.of_triangle[sides.mates[side] / 3];
    const Vec3 n = facets.facets[i].normal, m = facets.facets[k].normal;
    const Vec3 at = mesh.vertices[start_of(mesh, side)],
               axis = glm::normalize(way_along(mesh, side));
    const Vec3 across = glm::cross(n, axis), back = glm::cross(axis, m);
    const auto width = strip_width(mesh, facets, i, at, across),
               other = strip_width(mesh, facets, k, at, back);
    if (!width || !other) return std::nullopt;
    const Vec3 middle = 0.5 * *width * across, beyond = 0.5 * *other * back;
    const double sine = glm::dot(n, back);
    if (std::abs(sine) < 1e-4) return std::nullopt;
    const double way = glm::dot(beyond - middle, back) / sine;
    RoundForm form{at + middle + way * n, axis, 0.0, 0.0, 0.0, 0.0};
    form.radius = form.place(at).radius;
    const double widest = std::max(*width, *other);
    if (widest > widest_chord * form.radius) return std::nullopt;
    form.sagitta = 0.125 * widest * widest / (form.radius * form.radius);
    return form;
}

std::optional<RoundForm> refined(const Mesh& mesh, double noise, RoundForm form,
                                 std::span<const uint32_t> triangles) {
    // The diagonals of long strips deviate little in angle, but by the width of the strip.
    const auto is_along = [&](const Vec3& way) {
        return glm::length(glm::cross(way, form.axis)) <= 8.0 * noise + 1e-6 * glm::length(way);
    };
    double longest = 0.0;
    for_each_side(triangles, [&](uint32_t side) {
        const Vec3 way = way_along(mesh, side);
        if (is_along(way)) longest = std::max(longest, glm::length(way));
    });
    Vec3 axis(0.0);
    std::vector<uint32_t> ends; // not those of slivers at the border of a wall, which can be off
    for_each_side(triangles, [&](uint32_t side) {
        const Vec3 way = way_along(mesh, side);
        if (!is_along(way) || glm::length(way) < 0.1 * longest) return;
        axis += glm::dot(way, form.axis) < 0.0 ? -way : way;
        ends.push_back(start_of(mesh, side));
        ends.push_back(end_of(mesh, side));
    });
    form.axis = glm::normalize(axis);
    for (int k = 0; k < 3; ++k) { // an axis of the frame, within the precision
        if (1.0 - std::abs(form.axis[k]) > 1e-12) continue;
        const double sign = form.axis[k];
        form.axis = Vec3(0.0);
        form.axis[k] = std::copysign(1.0, sign);
    }
    const Vec3 u = perpendicular(form.axis), v = glm::cross(form.axis, u);
    std::vector<glm::dvec2> points;
    for (const uint32_t i : ends) {
        const Vec3 p = mesh.vertices[i] - form.origin;
        points.emplace_back(glm::dot(p, u), glm::dot(p, v));
    }
    const auto fit = fitted_circle(points);
    if (!fit) return std::nullopt;
    form.origin += fit->center.x * u + fit->center.y * v;
    form.radius = fit->radius;
    return form;
}

} // namespace core

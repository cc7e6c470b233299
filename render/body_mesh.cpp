#include "render/body_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/math.h"
#include "core/dbm/solid.h"
#include "core/geom/mesh.h"
#include "core/geom/profile.h"

namespace render {

namespace {

using core::Vec3;

/// Chords of a circle that stay within `sag` of it; a multiple of 4, so that quarters are exact.
int chords_of(double radius, double sag) {
    const double angle = core::acos(std::clamp(1.0 - sag / std::max(radius, sag), -1.0, 1.0));
    const int quarter =
        static_cast<int>(std::ceil(0.25 * std::numbers::pi / std::max(angle, 1e-3)));
    return 4 * std::clamp(quarter, 6, 32);
}

/// Rings of vertices about Z, and triangles between rings.
struct Rings {
    core::Mesh mesh;
    int chords;

    /// The first vertex of a ring; a ring without radius is one vertex.
    uint32_t add(const OutlinePoint& at) {
        const auto first = static_cast<uint32_t>(mesh.vertices.size());
        const int count = at.r > 0.0 ? chords : 1;
        for (int i = 0; i < count; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / chords;
            mesh.vertices.emplace_back(at.r * core::cos(angle), at.r * core::sin(angle), at.z);
        }
        return first;
    }
    /// Adds the triangles between two rings; `lower` and `upper` are in order along the outline,
    /// from the tip up.
    void join(uint32_t lower, bool lower_is_point, uint32_t upper, bool upper_is_point) {
        for (int i = 0; i < chords; ++i) {
            const auto a = static_cast<uint32_t>(i), b = static_cast<uint32_t>((i + 1) % chords);
            if (!lower_is_point)
                mesh.triangles.push_back(
                    {lower + a, lower + b, upper_is_point ? upper : upper + b});
            if (!upper_is_point)
                mesh.triangles.push_back(
                    {lower_is_point ? lower : lower + a, upper + b, upper + a});
        }
    }
};

core::Mesh revolved(const std::vector<OutlinePoint>& outline, double sag) {
    double widest = 0.0;
    for (const OutlinePoint& p : outline) widest = std::max(widest, p.r);
    Rings rings{{}, chords_of(widest, sag)};
    uint32_t last = 0;
    for (size_t i = 0; i < outline.size(); ++i) {
        const uint32_t here = rings.add(outline[i]);
        if (i > 0) rings.join(last, outline[i - 1].r <= 0.0, here, outline[i].r <= 0.0);
        last = here;
    }
    return std::move(rings.mesh);
}

/// Directions spread over a ball, in rings about Z.
core::Mesh directions(int divisions) {
    std::vector<OutlinePoint> outline;
    for (int i = 0; i <= divisions; ++i) {
        const double angle = std::numbers::pi * i / divisions;
        const bool pole = i == 0 || i == divisions;
        outline.push_back({pole ? 0.0 : core::sin(angle), -core::cos(angle)});
    }
    return revolved(outline, 0.003);
}

/// The surface of a shape, from its support points in directions all around.
TriangleMesh supported(const core::ConvexShape& shape, double margin) {
    const core::Mesh ball = directions(24);
    TriangleMesh made;
    for (const Vec3& direction : ball.vertices) {
        const Vec3 p = core::support(shape, direction).point + margin * direction;
        made.vertices.push_back({glm::vec3(p), packed_normal(direction)});
        made.bounds.extend(p);
    }
    made.triangles = ball.triangles;
    return made;
}

/// The corners of the face that lies in the plane of three points, in order; empty if other points
/// are beyond it.
std::vector<uint32_t> face_through(const std::vector<Vec3>& points, const Vec3& at,
                                   const Vec3& normal, double near) {
    std::vector<uint32_t> on;
    for (uint32_t i = 0; i < points.size(); ++i) {
        const double off = glm::dot(points[i] - at, normal);
        if (off > near) return {};
        if (off >= -near) on.push_back(i);
    }
    Vec3 middle(0.0);
    for (const uint32_t i : on) middle += points[i] / static_cast<double>(on.size());
    const Vec3 x = glm::normalize(points[on[0]] - middle), y = glm::cross(normal, x);
    const auto angle = [&](uint32_t i) {
        return core::atan2(glm::dot(points[i] - middle, y), glm::dot(points[i] - middle, x));
    };
    std::sort(on.begin(), on.end(), [&](uint32_t a, uint32_t b) { return angle(a) < angle(b); });
    return on;
}

/// The hull of a few points, by trying every plane through three of them.
core::Mesh hull_of(const std::vector<Vec3>& points) {
    core::Mesh mesh;
    mesh.vertices = points;
    core::Aabb box;
    for (const Vec3& p : points) box.extend(p);
    const double near = 1e-9 * std::max(1.0, glm::length(box.size()));
    std::vector<Vec3> found;
    for (size_t a = 0; a < points.size(); ++a)
        for (size_t b = 0; b < points.size(); ++b)
            for (size_t c = b + 1; c < points.size(); ++c) {
                if (b <= a) continue;
                Vec3 normal = glm::cross(points[b] - points[a], points[c] - points[a]);
                if (glm::length(normal) <= near) continue;
                normal = glm::normalize(normal);
                for (const Vec3& side : {normal, -normal}) {
                    if (std::any_of(found.begin(), found.end(),
                                    [&](const Vec3& f) { return glm::length(f - side) < 1e-9; }))
                        continue;
                    const std::vector<uint32_t> face = face_through(points, points[a], side, near);
                    if (face.size() < 3) continue;
                    found.push_back(side);
                    for (size_t i = 2; i < face.size(); ++i)
                        mesh.triangles.push_back({face[0], face[i - 1], face[i]});
                }
            }
    return mesh;
}

TriangleMesh cylinder_mesh(double radius, double z0, double z1, double sag) {
    return mesh_of(core::RevolvedProfile{{{z0, radius, z1, radius, 0.0}}}, sag);
}

/// Turns Z to an axis of the frame.
core::Mat3 z_to(int axis) {
    core::Mat3 turned(0.0);
    turned[2][axis] = 1.0;
    turned[0][core::Vec3::length_type((axis + 1) % 3)] = 1.0;
    turned[1][core::Vec3::length_type((axis + 2) % 3)] = 1.0;
    return turned;
}

} // namespace

TriangleMesh mesh_of(const core::RevolvedProfile& profile, double sag) {
    return shaded(revolved(outline_of(profile, sag), sag));
}

TriangleMesh mesh_of(const core::ConvexShape& shape, double sag) {
    TriangleMesh made;
    const Vec3 at = shape.positions[0].at;
    if (shape.core == core::ConvexShape::Core::cone) {
        core::ProfileElement cone = shape.cone;
        cone.margin = std::max(cone.margin, shape.margin);
        append(made, mesh_of(core::RevolvedProfile{{cone}}, sag), {shape.orientation, at});
        return made;
    }
    const std::vector<Vec3> points(shape.points.begin(), shape.points.begin() + shape.point_count);
    core::ConvexShape still = shape;
    still.position_count = 1;
    still.positions[0] = {};
    append(made,
           shape.margin > 0.0 || points.size() < 4 ? supported(still, shape.margin)
                                                   : shaded(hull_of(points)),
           core::translation(at));
    return made;
}

TriangleMesh mesh_of(const core::ExactBody& body, double sag) {
    if (const auto* shape = std::get_if<core::ConvexShape>(&body)) return mesh_of(*shape, sag);
    return shaded(*std::get<core::SolidMesh>(body).mesh);
}

TriangleMesh mesh_of(const core::Primitive& primitive, double sag) {
    if (const auto* sphere = std::get_if<core::Sphere>(&primitive))
        return ball_mesh(sphere->radius, 32);
    if (const auto* box = std::get_if<core::Box>(&primitive))
        return shaded(core::mesh_of(core::Aabb{-0.5 * box->size, 0.5 * box->size}));
    const auto& cylinder = std::get<core::Cylinder>(primitive);
    return cylinder_mesh(cylinder.radius, -0.5 * cylinder.height, 0.5 * cylinder.height, sag);
}

TriangleMesh mesh_of(const core::Solid& solid, double sag) {
    if (const auto* box = std::get_if<core::SolidBox>(&solid.shape))
        return shaded(core::mesh_of(box->box));
    if (const auto* mesh = std::get_if<core::SolidMesh>(&solid.shape)) return shaded(*mesh->mesh);
    const auto& c = std::get<core::SolidCylinder>(solid.shape);
    TriangleMesh made;
    append(made, cylinder_mesh(c.radius, 0.0, c.height, sag), {z_to(c.axis), c.base});
    return made;
}

TriangleMesh ball_mesh(double radius, int divisions) {
    core::Mesh ball = directions(divisions);
    for (Vec3& p : ball.vertices) p *= radius;
    return shaded(ball, std::numbers::pi);
}

namespace {

constexpr double tiny = 1e-9; // mm

using Outline = std::vector<OutlinePoint>;

/// An arc about (r, z), angles from the radial direction upwards.
struct Arc {
    double r, z, radius, from, to;
};

void add_arc(Outline& outline, const Arc& arc, double sag) {
    const double step =
        2.0 * core::acos(std::clamp(1.0 - sag / std::max(arc.radius, sag), 0.0, 1.0));
    const double turn = arc.to - arc.from;
    const int chords =
        std::max(1, static_cast<int>(std::ceil(turn / std::clamp(step, 0.03, 0.25))));
    for (int i = 0; i <= chords; ++i) {
        const double angle = arc.from + turn * i / chords;
        outline.push_back({std::max(0.0, arc.r + arc.radius * core::cos(angle)),
                           arc.z + arc.radius * core::sin(angle)});
    }
}

/// The outline of one piece without the flat faces at its ends; heights do not decrease.
Outline outline_of(const core::ProfileElement& e, double sag) {
    if (e.margin <= 0.0) return {{e.r0, e.z0}, {e.r1, e.z1}};
    const double flank = core::atan2(-(e.r1 - e.r0), e.z1 - e.z0);
    Outline outline;
    add_arc(outline, {e.r0, e.z0, e.margin, -0.5 * std::numbers::pi, flank}, sag);
    add_arc(outline, {e.r1, e.z1, e.margin, flank, 0.5 * std::numbers::pi}, sag);
    return outline;
}

/// A straight segment of an outline between two heights.
struct Line {
    double r0, r1;
};

/// The segment of a piece between two heights at which none of its segments begins or ends.
std::optional<Line> line_between(const Outline& outline, double z0, double z1) {
    const double middle = 0.5 * (z0 + z1);
    for (size_t i = 1; i < outline.size(); ++i) {
        const OutlinePoint &a = outline[i - 1], &b = outline[i];
        if (!(a.z < middle && middle < b.z)) continue;
        const double slope = (b.r - a.r) / (b.z - a.z);
        return Line{a.r + slope * (z0 - a.z), a.r + slope * (z1 - a.z)};
    }
    return std::nullopt;
}

std::vector<double> sorted_once(std::vector<double> heights) {
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end(),
                              [](double a, double b) { return b - a < tiny; }),
                  heights.end());
    return heights;
}

/// All heights at which the outline of the union may bend.
std::vector<double> bends(const std::vector<Outline>& pieces) {
    std::vector<double> heights;
    for (const Outline& piece : pieces)
        for (const OutlinePoint& p : piece) heights.push_back(p.z);
    heights = sorted_once(std::move(heights));
    std::vector<double> crossings = heights;
    for (size_t i = 1; i < heights.size(); ++i) {
        const double z0 = heights[i - 1], z1 = heights[i];
        std::vector<Line> lines;
        for (const Outline& piece : pieces)
            if (const auto line = line_between(piece, z0, z1)) lines.push_back(*line);
        for (size_t a = 0; a < lines.size(); ++a)
            for (size_t b = a + 1; b < lines.size(); ++b) {
                const double low = lines[a].r0 - lines[b].r0, high = lines[a].r1 - lines[b].r1;
                if (low * high < 0.0) crossings.push_back(z0 + (z1 - z0) * low / (low - high));
            }
    }
    return sorted_once(std::move(crossings));
}

void add(Outline& outline, const OutlinePoint& p) {
    if (!outline.empty() && std::abs(outline.back().r - p.r) < tiny
        && std::abs(outline.back().z - p.z) < tiny)
        return;
    // A point between two others on the same line is redundant.
    while (outline.size() >= 2) {
        const OutlinePoint &a = outline[outline.size() - 2], &b = outline.back();
        const double cross = (b.r - a.r) * (p.z - a.z) - (b.z - a.z) * (p.r - a.r);
        const double along = (b.r - a.r) * (p.r - b.r) + (b.z - a.z) * (p.z - b.z);
        if (std::abs(cross) > tiny * core::hypot(p.r - a.r, p.z - a.z) || along < 0.0) break;
        outline.pop_back();
    }
    outline.push_back(p);
}

} // namespace

std::vector<OutlinePoint> outline_of(const core::RevolvedProfile& profile, double sag) {
    std::vector<Outline> pieces;
    for (const core::ProfileElement& e : profile.elements) pieces.push_back(outline_of(e, sag));
    const std::vector<double> heights = bends(pieces);
    Outline outline;
    for (size_t i = 1; i < heights.size(); ++i) {
        Line widest{0.0, 0.0};
        for (const Outline& piece : pieces) {
            const auto line = line_between(piece, heights[i - 1], heights[i]);
            if (line && line->r0 + line->r1 > widest.r0 + widest.r1) widest = *line;
        }
        if (outline.empty()) add(outline, {0.0, heights[i - 1]});
        add(outline, {std::max(widest.r0, 0.0), heights[i - 1]});
        add(outline, {std::max(widest.r1, 0.0), heights[i]});
    }
    if (!outline.empty()) add(outline, {0.0, heights.back()});
    return outline;
}

} // namespace render

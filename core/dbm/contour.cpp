#include "core/dbm/contour.h"

#include <algorithm>
#include <array>

#include "core/base/math.h"
#include "core/dbm/cut_model.h"
#include "core/geom/triangle_distance.h"

namespace core {
namespace {

/// Directions with less than this fraction of the greatest eigenvalue are ignored: edges flatter
/// than some 16 degrees count as curvature.
constexpr double weakest = 0.02;

using Matrix = std::array<std::array<double, 3>, 3>;

/// Turns the matrix so that the entry (p, q) vanishes, and the frame with it.
void rotate(Matrix& a, Matrix& frame, size_t p, size_t q) {
    if (a[p][q] == 0.0) return;
    const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    const double t =
        (theta < 0.0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
    const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
    for (size_t k = 0; k < 3; ++k) {
        const double kp = a[k][p], kq = a[k][q];
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
    }
    for (size_t k = 0; k < 3; ++k) {
        const double pk = a[p][k], qk = a[q][k];
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
        const double fp = frame[k][p], fq = frame[k][q];
        frame[k][p] = c * fp - s * fq;
        frame[k][q] = s * fp + c * fq;
    }
}

} // namespace

Vec3 feature_point(std::span<const TangentPlane> points, const Aabb& room) {
    Vec3 middle(0.0);
    for (const TangentPlane& point : points) middle += point.position;
    middle /= static_cast<double>(points.size());
    const bool flat = std::all_of(points.begin(), points.end(), [&](const TangentPlane& point) {
        return point.normal == points.front().normal;
    });
    if (flat) return glm::clamp(middle, room.min, room.max); // the mean is in their common plane
    Matrix a{}, frame{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    Vec3 right(0.0);
    for (const TangentPlane& point : points) {
        const Vec3& n = point.normal;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                a[static_cast<size_t>(i)][static_cast<size_t>(j)] += n[i] * n[j];
        right += glm::dot(n, point.position - middle) * n;
    }
    for (int sweep = 0; sweep < 12; ++sweep)
        for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}})
            rotate(a, frame, static_cast<size_t>(p), static_cast<size_t>(q));
    const double strongest = std::max({a[0][0], a[1][1], a[2][2]});
    Vec3 by(0.0);
    for (size_t k = 0; k < 3; ++k) {
        if (!(a[k][k] > weakest * strongest)) continue;
        const Vec3 direction(frame[0][k], frame[1][k], frame[2][k]);
        by += glm::dot(direction, right) / a[k][k] * direction;
    }
    return glm::clamp(middle + by, room.min, room.max);
}

namespace {

/// The signed distance of a point from a body, negative inside, and its gradient.
struct Facing {
    double outside = infinity;
    Vec3 normal = Vec3(0.0);
};

Facing facing(const ProfileElement& e, const Vec3& p) {
    const double r = core::hypot(p.x, p.y);
    const Vec3 radial = r > 0.0 ? Vec3(p.x / r, p.y / r, 0.0) : Vec3(1.0, 0.0, 0.0);
    if (e.margin > 0.0) {
        const double beyond = std::max(0.0, r - std::max(e.r0, e.r1)), rise = p.z - e.z0;
        const double away = core::hypot(beyond, rise);
        const Vec3 out = beyond * radial + Vec3(0.0, 0.0, rise);
        return {away - e.margin, away > 0.0 ? out / away : Vec3(0.0, 0.0, 1.0)};
    }
    const double slope = (e.r1 - e.r0) / (e.z1 - e.z0);
    const Vec3 flank = (radial - Vec3(0.0, 0.0, slope)) / std::sqrt(1.0 + slope * slope);
    Facing most{(r - e.r0 - slope * (p.z - e.z0)) / std::sqrt(1.0 + slope * slope), flank};
    if (e.z0 - p.z > most.outside) most = {e.z0 - p.z, Vec3(0.0, 0.0, -1.0)};
    if (p.z - e.z1 > most.outside) most = {p.z - e.z1, Vec3(0.0, 0.0, 1.0)};
    return most;
}

/// The normal of the surface swept at `p`, which is perpendicular to the motion. If the normal of
/// the face is not, `p` is on a rim, and the rim sweeps the surface.
Vec3 across_motion(const ProfileElement& e, const Vec3& p, const Vec3& normal, const Vec3& by) {
    if (std::abs(glm::dot(normal, by)) <= 1e-6 * glm::length(by)) return normal;
    const Vec3 across = glm::cross(by, Vec3(-p.y, p.x, 0.0));
    const double size = glm::length(across);
    if (!(size > 0.0)) return normal;
    const Vec3 out = p - Vec3(0.0, 0.0, 0.5 * (e.z0 + e.z1));
    return glm::dot(across, out) < 0.0 ? -across / size : across / size;
}

/// The signed distance from the moving piece at the time of least distance, and its gradient. `p`
/// and `by` are in the frame of the tool, relative to the initial tip position.
Facing facing_sweep(const ProfileElement& e, const Vec3& p, const Vec3& by) {
    // The distance is convex in time, and its normal gives the direction of descent.
    const auto at = [&](double t) { return facing(e, p - t * by); };
    const auto rises = [&](const Facing& f) { return -glm::dot(f.normal, by); };
    if (const Facing first = at(0.0); rises(first) >= 0.0) return first;
    if (const Facing last = at(1.0); rises(last) <= 0.0) return last;
    double low = 0.0, high = 1.0, middle = 0.5;
    if (e.margin > 0.0 && e.r0 == 0.0 && e.r1 == 0.0) { // a ball
        middle = glm::dot(p - Vec3(0.0, 0.0, e.z0), by) / glm::dot(by, by);
    } else {
        for (int i = 0; i < 40; ++i) {
            middle = 0.5 * (low + high);
            const double slope = rises(at(middle));
            if (slope == 0.0) break;
            (slope < 0.0 ? low : high) = middle;
        }
    }
    Facing best = at(middle);
    best.normal = across_motion(e, p - middle * by, best.normal, by);
    return best;
}

/// The normal of a cut surface, which points out of the stock, into the cut volume.
Vec3 normal_of_cut(const CutterSweep& sweep, const Vec3& point) {
    const Mat3 tool_from_stock = glm::transpose(sweep.orientation);
    const Vec3 p = tool_from_stock * (point - sweep.from);
    const Vec3 by = tool_from_stock * (sweep.to - sweep.from);
    Facing deepest;
    for (const Cutter::Piece& piece : sweep.cutter->pieces)
        for (const ProfileElement& e : piece.around.elements) {
            const Facing here = facing_sweep(e, p, by);
            if (here.outside < deepest.outside) deepest = here;
        }
    return -(sweep.orientation * deepest.normal);
}

/// The normal of the face that a line crosses at its end `point`. On a rim this could be the
/// adjacent face along which the line runs: slightly off that face, the other one is nearer.
Vec3 normal_at_end(const CutterSweep& sweep, const Vec3& point, const Vec3& outward) {
    constexpr double off = 1e-4, along = 1e-6;
    const Vec3 normal = normal_of_cut(sweep, point);
    if (glm::dot(normal, outward) >= along) return normal;
    const Vec3 normal_near = normal_of_cut(sweep, point + off * normal);
    return glm::dot(normal_near, outward) >= along ? normal_near : normal;
}

Vec3 normal_of_cylinder(const SolidCylinder& c, const Vec3& point, int axis, const Vec3& outward) {
    if (axis == c.axis) return outward;
    Vec3 radial = point - c.base;
    radial[c.axis] = 0.0;
    return glm::normalize(radial);
}

/// The normal of the triangle that is most nearly perpendicular to the line, of those at the point.
Vec3 normal_of_mesh(const SolidMesh& mesh, const Vec3& point, const Vec3& outward) {
    constexpr double near = 1e-6;
    Vec3 best = outward;
    double least = infinity;
    for (const uint32_t id : triangles_in(*mesh.bvh, Aabb{point, point}.grown(near))) {
        const Triangle t = mesh.mesh->triangle(id);
        const Vec3 across = glm::cross(t.b - t.a, t.c - t.a);
        const double size = glm::length(across);
        if (!(size > 0.0) || glm::dot(across, outward) <= 0.0) continue;
        const double off = std::abs(glm::dot(across / size, point - t.a));
        if (off < least) {
            least = off;
            best = across / size;
        }
    }
    return best;
}

Vec3 normal_of_raw(const Solid& solid, const Vec3& point, int axis, const Vec3& outward) {
    if (const auto* c = std::get_if<SolidCylinder>(&solid.shape))
        return normal_of_cylinder(*c, point, axis, outward);
    if (const auto* m = std::get_if<SolidMesh>(&solid.shape))
        return normal_of_mesh(*m, point, outward);
    return outward;
}

} // namespace

SurfacePoint surface_point(const CutModel& model, const LineEnd& end) {
    const ScanLines& family = model.lines.families[static_cast<size_t>(end.axis)];
    const Interval matter = family.line(end.u, end.v)[end.interval];
    const EndMarks marks = family.marks(end.u, end.v, end.interval);
    const uint32_t mark = end.upper ? marks.upper : marks.lower;
    const Vec3 point = point_on_line(model.lines.grid, end.axis, end.u, end.v,
                                     end.upper ? matter.upper : matter.lower);
    Vec3 outward(0.0);
    outward[end.axis] = end.upper ? 1.0 : -1.0;
    if (mark == 0) return {point, normal_of_raw(model.solid, point, end.axis, outward), {}};
    const CutterSweep sweep = model.log[model.log.index_of(mark)].sweep;
    return {point, normal_at_end(sweep, point, outward), sweep.block};
}

namespace {

/// How far beyond an edge an end still counts as on the edge, mm.
constexpr double contour_slack = 1e-6;

} // namespace

IndexRange lines_within(const ScanGrid& grid, int axis, const Interval& matter) {
    const double start = grid.coordinate(axis, 0);
    const int last = grid.count(axis) - 1;
    const auto clipped = [&](double index, int low, int high) {
        return static_cast<int>(std::clamp(index, static_cast<double>(low), high + 0.0));
    };
    IndexRange range{clipped(std::ceil((matter.lower - start) / grid.spacing) - 1.0, 0, last + 1),
                     clipped(std::floor((matter.upper - start) / grid.spacing) + 1.0, -1, last)};
    while (range.first <= last && grid.coordinate(axis, range.first) < matter.lower) ++range.first;
    while (range.last >= 0 && grid.coordinate(axis, range.last) > matter.upper) --range.last;
    return range;
}

Crossing crossing_at(const Dbm& lines, int axis, const std::array<int, 3>& node, bool from_inside) {
    const ScanGrid& grid = lines.grid;
    const int u = node[static_cast<size_t>(u_axis(axis))] - 1;
    const int v = node[static_cast<size_t>(v_axis(axis))] - 1;
    const int step = node[static_cast<size_t>(axis)] - 1;
    const double low = grid.coordinate(axis, step), high = grid.coordinate(axis, step + 1);
    const LineView matter = lines.families[static_cast<size_t>(axis)].line(u, v);
    Crossing crossing{{axis, u, v, 0, from_inside}, 0.5 * (low + high)};
    double best = contour_slack;
    for (size_t i = 0; i < matter.size(); ++i) {
        const double here = from_inside ? matter[i].upper : matter[i].lower;
        const double beyond = std::max({low - here, here - high, 0.0});
        if (beyond > best || (crossing.found && beyond == best)) continue;
        best = beyond;
        crossing.along = here;
        crossing.end.interval = i;
        crossing.found = true;
    }
    crossing.along = std::clamp(crossing.along, low, high);
    return crossing;
}

std::optional<uint32_t> sweep_at(const CutModel& model, const LineEnd& end) {
    const EndMarks marks =
        model.lines.families[static_cast<size_t>(end.axis)].marks(end.u, end.v, end.interval);
    const uint32_t mark = end.upper ? marks.upper : marks.lower;
    if (mark == 0) return std::nullopt;
    return static_cast<uint32_t>(model.log.index_of(mark));
}

CrossedEdge crossed_edge(const CutModel& model, const Crossing& crossing) {
    const LineEnd& end = crossing.end;
    CrossedEdge edge;
    if (crossing.found) {
        edge = {{Vec3(0.0), surface_point(model, end).normal}, sweep_at(model, end)};
    }
    // A line does not end at a face that it runs along.
    const double outward = end.upper ? 1.0 : -1.0;
    if (!crossing.found || edge.plane.normal[end.axis] * outward < 1e-6) {
        edge.plane.normal = Vec3(0.0);
        edge.plane.normal[end.axis] = outward;
    }
    edge.plane.position = point_on_line(model.lines.grid, end.axis, end.u, end.v, crossing.along);
    return edge;
}

Aabb vertex_room(const ScanGrid& grid, const Aabb& bounds, const std::array<int, 3>& cell) {
    // Where a sharp edge leaves its cell through a side that lines cross on both flanks, only this
    // cell detects it: vertices may lie in the neighbouring cell.
    const auto corner = [&](int by) {
        const Vec3 node(grid.coordinate(0, cell[0] - 1 + by), grid.coordinate(1, cell[1] - 1 + by),
                        grid.coordinate(2, cell[2] - 1 + by));
        return glm::clamp(node, bounds.min, bounds.max);
    };
    return {corner(-1), corner(2)};
}

double distance_to(const Triangle& triangle, const Vec3& point) {
    return glm::distance(point, nearest_point(triangle, point));
}

Diagonal better_diagonal(const std::array<Vec3, 4>& corners, const Vec3& point) {
    double away[2];
    for (size_t k = 0; k < 2; ++k)
        away[k] = std::min(distance_to({corners[k], corners[k + 1], corners[k + 2]}, point),
                           distance_to({corners[k], corners[k + 2], corners[(k + 3) % 4]}, point));
    const size_t k = away[1] < away[0] - 1e-9 ? 1 : 0;
    return {k, away[k]};
}

} // namespace core

#include "core/dbm/surface_point.h"

namespace core {
namespace {

/// How far a point lies outside a body, negative inside, and the direction in which that grows.
struct Facing {
    double outside = infinity;
    Vec3 normal = Vec3(0.0);
};

Facing facing(const ProfileElement& e, const Vec3& p) {
    const double r = std::hypot(p.x, p.y);
    const Vec3 radial = r > 0.0 ? Vec3(p.x / r, p.y / r, 0.0) : Vec3(1.0, 0.0, 0.0);
    if (e.margin > 0.0) {
        const double beyond = std::max(0.0, r - std::max(e.r0, e.r1)), rise = p.z - e.z0;
        const double away = std::hypot(beyond, rise);
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

/// The normal of what the surface at `p` sweeps, which is across the motion. A face that is not is
/// but one of the two at a rim: it is the rim that sweeps.
Vec3 across_motion(const ProfileElement& e, const Vec3& p, const Vec3& normal, const Vec3& by) {
    if (std::abs(glm::dot(normal, by)) <= 1e-6 * glm::length(by)) return normal;
    const Vec3 across = glm::cross(by, Vec3(-p.y, p.x, 0.0));
    const double size = glm::length(across);
    if (!(size > 0.0)) return normal;
    const Vec3 out = p - Vec3(0.0, 0.0, 0.5 * (e.z0 + e.z1));
    return glm::dot(across, out) < 0.0 ? -across / size : across / size;
}

/// The same for the piece while it moves: how far outside at the moment when that is least. `p` and
/// `by` are in the tool's frame, from where the tip stands at first.
Facing facing_sweep(const ProfileElement& e, const Vec3& p, const Vec3& by) {
    // How far outside is convex in time, and its normal says which way it falls.
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

/// Out of the stock is into what was cut.
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

/// The normal of the face that a line passes where its end is at `point`. On a rim that may come
/// out as the face beside it, along which the line runs: a little off that one, the other is
/// nearer.
Vec3 normal_at_end(const CutterSweep& sweep, const Vec3& point, const Vec3& outward) {
    constexpr double off = 1e-4, along = 1e-6;
    const Vec3 normal = normal_of_cut(sweep, point);
    if (glm::dot(normal, outward) >= along) return normal;
    const Vec3 beside = normal_of_cut(sweep, point + off * normal);
    return glm::dot(beside, outward) >= along ? beside : normal;
}

Vec3 normal_of_cylinder(const SolidCylinder& c, const Vec3& point, int axis, const Vec3& outward) {
    if (axis == c.axis) return outward;
    Vec3 radial = point - c.base;
    radial[c.axis] = 0.0;
    return glm::normalize(radial);
}

/// That of the triangle which the line passes nearest to its plane, among those at the point.
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
    const CutterSweep sweep = model.log[mark - 1].sweep;
    return {point, normal_at_end(sweep, point, outward), sweep.block};
}

std::vector<SurfacePoint> surface_points(const CutModel& model, int axis) {
    const ScanLines& family = model.lines.families[static_cast<size_t>(axis)];
    std::vector<SurfacePoint> points;
    for (int v = 0; v < family.v_count(); ++v)
        for (int u = 0; u < family.u_count(); ++u)
            for (size_t i = 0; i < family.line(u, v).size(); ++i)
                for (const bool upper : {false, true})
                    points.push_back(surface_point(model, {axis, u, v, i, upper}));
    return points;
}

} // namespace core

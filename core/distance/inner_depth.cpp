#include "core/distance/inner_depth.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"
#include "core/dbm/dbm.h"
#include "core/dbm/solid.h"
#include "core/geom/profile.h"
#include "core/geom/triangle_bvh.h"

namespace core {
namespace {

ConvexShape point_at(const Vec3& p) {
    ConvexShape shape = convex_sphere(0.0);
    shape.points[0] = p;
    return shape;
}

/// Depth below the nearest of the faces of a hull, found from all triples of its corners; negative
/// for a point outside, infinite for a flat hull.
double depth_below_faces(const ConvexShape& hull, const Vec3& point) {
    const size_t count = hull.point_count;
    double depth = infinity;
    for (size_t i = 0; i < count; ++i)
        for (size_t j = i + 1; j < count; ++j)
            for (size_t k = j + 1; k < count; ++k) {
                const Vec3& a = hull.points[i];
                const Vec3 across = glm::cross(hull.points[j] - a, hull.points[k] - a);
                const double length = glm::length(across);
                if (length <= 1e-9) continue;
                const Vec3 normal = across / length;
                double most = -infinity, least = infinity;
                for (size_t n = 0; n < count; ++n) {
                    const double height = glm::dot(hull.points[n] - a, normal);
                    most = std::max(most, height);
                    least = std::min(least, height);
                }
                const double height = glm::dot(point - a, normal);
                if (most <= 1e-9) depth = std::min(depth, -height);
                if (least >= -1e-9) depth = std::min(depth, height);
            }
    return depth;
}

/// Depth inside an upright truncated cone without its margin; negative outside.
double depth_in_cone(const ProfileElement& cone, const Vec3& p) {
    const double height = cone.z1 - cone.z0, out = cone.r1 - cone.r0;
    const double side = core::hypot(height, out);
    if (height <= 0.0) return -infinity;
    const double radius = cone.r0 + out * (p.z - cone.z0) / height;
    return std::min(
        {p.z - cone.z0, cone.z1 - p.z, (radius - core::hypot(p.x, p.y)) * height / side});
}

double depth_in_core(const ConvexShape& shape, const Vec3& local) {
    if (shape.core == ConvexShape::Core::points) {
        const double depth = depth_below_faces(shape, local);
        return std::isfinite(depth) ? depth : -infinity;
    }
    return depth_in_cone(shape.cone, glm::transpose(shape.orientation) * local);
}

double depth_in_convex(const ConvexShape& shape, const Vec3& point) {
    const double depth = depth_in_core(shape, point - shape.positions[0].at);
    if (depth >= 0.0) return depth + shape.margin;
    ConvexShape core = shape;
    core.margin = 0.0;
    return shape.margin - separation(point_at(point), core).upper;
}

double depth_in_mesh(const SolidMesh& solid, const Vec3& point) {
    const Separation found = separation(point_at(point), *solid.bvh);
    return holds(solid, point) ? found.lower : -found.upper;
}

double length_of(double u, double v) { return std::sqrt(u * u + v * v); }

/// A square across a family of scan lines, by its centre relative to a point.
struct Cell {
    double u = 0.0, v = 0.0;
    double near = 0.0; // least distance from the point
};

/// The cells of a size whose distance from the origin is below `radius`, the nearest first.
std::vector<Cell> cells_around(double size, double radius) {
    std::vector<Cell> cells;
    const int count = static_cast<int>(std::ceil(radius / size + 0.5));
    for (int i = -count; i <= count; ++i)
        for (int j = -count; j <= count; ++j) {
            const double near = length_of(std::max(0.0, (std::abs(i) - 0.5) * size),
                                          std::max(0.0, (std::abs(j) - 0.5) * size));
            if (near < radius) cells.push_back({i * size, j * size, near});
        }
    std::stable_sort(cells.begin(), cells.end(),
                     [](const Cell& a, const Cell& b) { return a.near < b.near; });
    return cells;
}

/// One family of scan lines, with each interval longer by what its line is closer than `reach` to a
/// cell.
class LineCover {
public:
    LineCover(const ScanGrid& grid, const ScanLines& lines, const Vec3& centre, double reach)
        : grid_(grid),
          lines_(lines),
          u_(centre[u_axis(lines.axis())]),
          v_(centre[v_axis(lines.axis())]),
          z_(centre[lines.axis()]),
          reach_(reach) {}

    /// How far the material covers the heights on both sides of the centre, over all of a cell.
    double over(double du, double dv, double half) {
        collect(u_ + du, v_ + dv, half);
        double low = infinity, high = -infinity;
        for (const Interval& each : covered_)
            if (each.lower <= z_ && z_ <= each.upper) {
                low = std::min(low, each.lower);
                high = std::max(high, each.upper);
            }
        if (low > high) return 0.0;
        for (bool grows = true; grows;) {
            grows = false;
            for (const Interval& each : covered_) {
                if (each.upper < low || each.lower > high) continue;
                grows = grows || each.lower < low || each.upper > high;
                low = std::min(low, each.lower);
                high = std::max(high, each.upper);
            }
        }
        return std::min(z_ - low, high - z_);
    }

private:
    int index(int axis, double at) const {
        return static_cast<int>(
            core::round_to_integer((at - grid_.coordinate(axis, 0)) / grid_.spacing));
    }

    void collect(double u, double v, double half) {
        covered_.clear();
        // Seven lines each way are enough: leaving some out only makes the result smaller.
        constexpr int side = 3;
        const int ua = u_axis(lines_.axis()), va = v_axis(lines_.axis());
        const int stride = std::max(1, static_cast<int>(reach_ / grid_.spacing / side));
        const int u0 = index(ua, u), v0 = index(va, v);
        for (int i = -side; i <= side; ++i)
            for (int j = -side; j <= side; ++j) {
                const int at_u = u0 + i * stride, at_v = v0 + j * stride;
                if (at_u < 0 || at_v < 0 || at_u >= lines_.u_count() || at_v >= lines_.v_count())
                    continue;
                const double off_u = std::abs(grid_.coordinate(ua, at_u) - u) + half;
                const double off_v = std::abs(grid_.coordinate(va, at_v) - v) + half;
                const double rest = reach_ * reach_ - off_u * off_u - off_v * off_v;
                if (rest <= 0.0) continue;
                const double longer = std::sqrt(rest);
                for (const Interval each : lines_.line(at_u, at_v))
                    covered_.push_back({each.lower - longer, each.upper + longer});
            }
    }

    const ScanGrid& grid_;
    const ScanLines& lines_;
    double u_, v_, z_, reach_;
    std::vector<Interval> covered_;
};

double radius_of(const ScanGrid& grid, const ScanLines& lines, const Vec3& centre, double reach,
                 const CoverGoal& goal) {
    LineCover cover(grid, lines, centre, reach);
    // More cannot be proven than what the lines around the centre show.
    double radius = std::min(goal.limit, cover.over(0.0, 0.0, 0.0));
    if (radius <= goal.enough) return 0.0;
    const double size =
        grid.spacing * std::max(1.0, std::ceil(radius / (goal.fineness * grid.spacing)));
    for (const Cell& cell : cells_around(size, radius)) {
        if (cell.near >= radius) break;
        radius = std::min(radius, length_of(cell.near, cover.over(cell.u, cell.v, 0.5 * size)));
        if (radius <= goal.enough) return 0.0;
    }
    return radius;
}

} // namespace

double inner_depth(const ExactBody& body, const Vec3& point) {
    if (const auto* shape = std::get_if<ConvexShape>(&body)) return depth_in_convex(*shape, point);
    return depth_in_mesh(std::get<SolidMesh>(body), point);
}

double inner_depth(const RevolvedProfile& profile, const Vec3& point) {
    double depth = -infinity;
    for (const ProfileElement& element : profile.elements)
        if (const double inside = depth_in_cone(element, point); inside >= 0.0)
            depth = std::max(depth, inside + element.margin);
    for (const ProfileElement& element : profile.elements) {
        if (depth >= element.margin || depth_in_cone(element, point) >= 0.0) continue;
        ConvexShape core = convex(element);
        core.margin = 0.0;
        depth = std::max(depth, element.margin - separation(point_at(point), core).upper);
    }
    return depth;
}

CoveredRadius covered_radius(const Dbm& model, const Vec3& centre, double reach,
                             const CoverGoal& goal) {
    CoveredRadius best{.radius = 0.0};
    for (const ScanLines& lines : model.families) {
        if (goal.axis >= 0 && lines.axis() != goal.axis) continue;
        CoverGoal more = goal;
        more.enough = std::max(goal.enough, best.radius);
        const double radius = radius_of(model.grid, lines, centre, reach, more);
        if (radius > best.radius) best = {radius, lines.axis()};
    }
    return best;
}

} // namespace core

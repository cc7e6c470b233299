#include "core/geom/triangle_distance.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace core {
namespace {

/// Triangles closer than this touch, as for convex shapes.
constexpr double touching = 1e-10;

/// A triangle with its sides; side i leads from corner i to the next, the other corner is `across`.
struct Sides {
    std::array<Vec3, 3> corner;
    std::array<Vec3, 3> along;
    std::array<double, 3> per_square; // 1 / length^2; 0 for a side without length

    explicit Sides(const Triangle& t) : corner{t.a, t.b, t.c} {
        for (size_t i = 0; i < 3; ++i) {
            along[i] = corner[(i + 1) % 3] - corner[i];
            const double square = glm::dot(along[i], along[i]);
            per_square[i] = square > 0.0 ? 1.0 / square : 0.0;
        }
    }
    const Vec3& across(size_t i) const { return corner[(i + 2) % 3]; }
};

/// A point of each triangle and the direction from the first to the second, which may be known more
/// accurately than from their difference.
struct Candidate {
    Vec3 on_a = Vec3(0.0), on_b = Vec3(0.0);
    Vec3 way = Vec3(0.0);
    double square = infinity; // of their distance
};

double clamped(double x) { return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x; }

/// The nearest points of side i of A and side j of B.
Candidate between_sides(const Sides& a, size_t i, const Sides& b, size_t j) {
    const Vec3 apart = b.corner[j] - a.corner[i];
    const double both = glm::dot(a.along[i], b.along[j]);
    const double on_a = glm::dot(a.along[i], apart) * a.per_square[i];
    const double on_b = glm::dot(b.along[j], apart) * b.per_square[j];
    // For each side, the foot of the perpendicular from the other's start, and its change as the
    // other's point moves.
    const double slide_a = both * a.per_square[i], slide_b = both * b.per_square[j];
    const double flat = 1.0 - slide_a * slide_b; // sine squared of the angle between them
    double s = flat > 0.0 ? clamped((on_a - slide_a * on_b) / flat) : 0.0;
    double t = s * slide_b - on_b;
    if (t < 0.0 || t > 1.0) {
        t = clamped(t);
        s = clamped(on_a + t * slide_a);
    }
    Candidate c;
    c.on_a = a.corner[i] + s * a.along[i];
    c.on_b = b.corner[j] + t * b.along[j];
    c.way = c.on_b - c.on_a;
    c.square = glm::dot(c.way, c.way);
    return c;
}

/// The nearest points of any two sides; ends early at a pair between which a plane shows that
/// nothing is nearer.
Candidate between_all_sides(const Sides& a, const Sides& b) {
    Candidate best;
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) {
            const Candidate c = between_sides(a, i, b, j);
            if (!(c.square < best.square)) continue;
            best = c;
            if (glm::dot(a.across(i) - c.on_a, c.way) <= 0.0
                && glm::dot(b.across(j) - c.on_b, c.way) >= 0.0)
                return best;
        }
    return best;
}

/// The foot of the perpendicular from `p` on the plane of the face, as a weighted mean of the
/// corners, which is in the face however inaccurate the normal is; empty if the foot is outside.
std::optional<Vec3> foot_in(const Sides& face, const Vec3& normal, const Vec3& p) {
    const double square = glm::dot(normal, normal);
    if (!(square > 0.0)) return std::nullopt;
    std::array<double, 3> weight = {1.0, 0.0, 0.0};
    Vec3 foot = face.corner[0];
    for (int pass = 0; pass < 2;
         ++pass) { // for a sliver the first pass has a large error, the second a small one
        const Vec3 scaled = glm::cross(p - foot, normal) / square;
        for (size_t i = 0; i < 3; ++i) weight[(i + 2) % 3] += glm::dot(face.along[i], scaled);
        const double sum = weight[0] + weight[1] + weight[2];
        foot = (weight[0] / sum) * face.corner[0] + (weight[1] / sum) * face.corner[1]
               + (weight[2] / sum) * face.corner[2];
    }
    const bool inside = weight[0] >= 0.0 && weight[1] >= 0.0 && weight[2] >= 0.0;
    return inside ? std::optional(foot) : std::nullopt;
}

/// The corner of B nearest to the plane of A, if all corners are on one side of the plane and this
/// one is above the face of A: only then can a face and a corner be nearest.
Candidate between_face_and_corner(const Sides& a, const Sides& b) {
    const Vec3 normal = glm::cross(a.along[0], a.along[1]);
    std::array<double, 3> height;
    for (size_t i = 0; i < 3; ++i) height[i] = glm::dot(b.corner[i] - a.corner[0], normal);
    const double side = height[0] < 0.0 ? -1.0 : 1.0;
    size_t nearest = 0;
    for (size_t i = 0; i < 3; ++i) {
        if (!(side * height[i] > 0.0)) return {};
        if (side * height[i] < side * height[nearest]) nearest = i;
    }
    const auto foot = foot_in(a, normal, b.corner[nearest]);
    if (!foot) return {};
    const Vec3 apart = b.corner[nearest] - *foot;
    return {*foot, b.corner[nearest], side * normal, glm::dot(apart, apart)};
}

Candidate turned_round(Candidate c) {
    std::swap(c.on_a, c.on_b);
    c.way = -c.way;
    return c;
}

/// Pairs every corner of B, and every point where a side of B crosses the plane of A, with the
/// nearest point of A. Finds crossings, and pairs that the other functions miss by rounding.
Candidate between_face_and_sides(const Triangle& face, const Sides& a, const Sides& b) {
    const Vec3 normal = glm::cross(a.along[0], a.along[1]);
    Candidate best;
    const auto offer = [&](const Vec3& on_b) {
        const Vec3 on_a = nearest_point(face, on_b);
        const Vec3 way = on_b - on_a;
        if (glm::dot(way, way) < best.square) best = {on_a, on_b, way, glm::dot(way, way)};
    };
    for (size_t i = 0; i < 3; ++i) {
        offer(b.corner[i]);
        const double from = glm::dot(b.corner[i] - a.corner[0], normal);
        const double to = glm::dot(b.corner[(i + 1) % 3] - a.corner[0], normal);
        if ((from > 0.0) != (to > 0.0)) offer(b.corner[i] + (from / (from - to)) * b.along[i]);
    }
    return best;
}

/// The gap between two planes perpendicular to `way` with all of A before one and all of B after
/// the other.
double gap_along(const Sides& a, const Sides& b, const Vec3& way) {
    const Vec3 u = glm::normalize(way);
    const auto along = [&](const Vec3& p) { return glm::dot(p, u); };
    const double end_of_a = std::max({along(a.corner[0]), along(a.corner[1]), along(a.corner[2])});
    const double start_of_b =
        std::min({along(b.corner[0]), along(b.corner[1]), along(b.corner[2])});
    return start_of_b - end_of_a;
}

struct PairSearch {
    const Triangle& triangle_a;
    const Triangle& triangle_b;
    SeparationGoal goal;
    Sides a{triangle_a}, b{triangle_b};
    Separation found{.lower = 0.0};

    /// Updates both bounds with a candidate; returns whether they are close enough.
    bool offer(const Candidate& c) {
        const double distance = std::sqrt(c.square);
        if (distance < found.upper) {
            found.upper = distance <= touching ? 0.0 : distance;
            found.point_a = c.on_a;
            found.point_b = c.on_b;
        }
        if (found.upper == 0.0) return true;
        if (glm::dot(c.way, c.way) > 0.0)
            found.lower = std::max(found.lower, gap_along(a, b, c.way));
        return found.upper - found.lower <= goal.tolerance || found.lower >= goal.limit;
    }

    /// Close to contact, the difference of the nearest points is dominated by rounding; the
    /// directions across two sides are more accurate.
    bool try_planes_across_sides() {
        for (const Vec3& side_a : a.along)
            for (const Vec3& side_b : b.along) {
                const Vec3 way = glm::cross(side_a, side_b);
                if (!(glm::dot(way, way) > 0.0)) continue;
                found.lower = std::max({found.lower, gap_along(a, b, way), gap_along(a, b, -way)});
            }
        return found.upper - found.lower <= goal.tolerance || found.lower >= goal.limit;
    }

    Separation run() {
        if (offer(between_all_sides(a, b)) || offer(between_face_and_corner(a, b))
            || offer(turned_round(between_face_and_corner(b, a)))
            || offer(between_face_and_sides(triangle_a, a, b))
            || offer(turned_round(between_face_and_sides(triangle_b, b, a)))
            || try_planes_across_sides())
            return result();
        const Separation other = separation(convex(triangle_a), convex(triangle_b), goal);
        const double lower = std::max(found.lower, other.lower);
        if (other.upper < found.upper) found = other;
        found.lower = lower;
        return result();
    }

    Separation result() {
        if (found.upper == 0.0) found.point_b = found.point_a;
        found.lower = std::min(found.lower, found.upper);
        return found;
    }
};

} // namespace

Vec3 nearest_point(const Triangle& triangle, const Vec3& p) {
    const Sides t(triangle);
    Vec3 best = t.corner[0];
    double least = infinity;
    const auto offer = [&](const Vec3& q) {
        const double square = glm::dot(p - q, p - q);
        if (square >= least) return;
        least = square;
        best = q;
    };
    if (const auto foot = foot_in(t, glm::cross(t.along[0], t.along[1]), p)) offer(*foot);
    for (size_t i = 0; i < 3; ++i)
        offer(t.corner[i]
              + clamped(glm::dot(p - t.corner[i], t.along[i]) * t.per_square[i]) * t.along[i]);
    return best;
}

Separation separation(const Triangle& a, const Triangle& b, const SeparationGoal& goal) {
    return PairSearch{a, b, goal}.run();
}

NearestSurface nearest_surface(const TriangleBvh& mesh, const Vec3& point, double limit) {
    NearestSurface best;
    double best_squared = limit * limit;
    if (mesh.nodes.empty()) return best;
    std::vector<std::pair<double, uint32_t>> open = {
        {distance_squared(point, mesh.nodes[0].box), 0}};
    while (!open.empty()) {
        const auto [bound, index] = open.back();
        open.pop_back();
        if (bound >= best_squared) continue;
        const TriangleBvh::Node& node = mesh.nodes[index];
        if (!node.is_leaf()) {
            std::pair<double, uint32_t> children[2];
            for (uint32_t k = 0; k < 2; ++k)
                children[k] = {distance_squared(point, mesh.nodes[node.first + k].box),
                               node.first + k};
            if (children[0].first < children[1].first) std::swap(children[0], children[1]);
            open.insert(open.end(), {children[0], children[1]});
            continue;
        }
        for (uint32_t i = node.first; i < node.first + node.count; ++i) {
            const Vec3 near = nearest_point(mesh.triangles[i], point);
            const Vec3 by = near - point;
            if (const double squared = glm::dot(by, by); squared < best_squared) {
                best_squared = squared;
                best = {std::sqrt(squared), near, mesh.ids[i]};
            }
        }
    }
    return best;
}

NearestSurface SurfaceTracker::at(const Vec3& point) {
    // The point found last is at most this far from here, so the nearest one is, too.
    const double limit = last_distance_ + glm::distance(point, last_point_);
    const NearestSurface found = nearest_surface(mesh_, point, limit * (1.0 + 1e-9) + 1e-9);
    last_point_ = point;
    last_distance_ = found.distance;
    return found;
}

} // namespace core

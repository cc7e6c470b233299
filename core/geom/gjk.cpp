#include "core/geom/gjk.h"

#include <algorithm>

#include "core/geom/simplex.h"

namespace core {
namespace {

constexpr int max_steps = 100;

/// Nearer than this the bodies touch: a point of the simplex that should be the origin is off by
/// rounding.
constexpr double gjk_touching = 1e-10;

Simplex::Vertex support_pair(const ConvexShape& a, const ConvexShape& b, const Vec3& towards_a) {
    // The vertex of A - B that lies farthest back along the line from the origin to A - B.
    const SupportPoint on_a = support(a, -towards_a);
    const SupportPoint on_b = support(b, towards_a);
    return {on_a.point - on_b.point, on_a.point, on_b.point, on_a.time, 1.0};
}

bool already_in(const Simplex& simplex, const Simplex::Vertex& vertex) {
    for (size_t i = 0; i < static_cast<size_t>(simplex.count); ++i)
        if (simplex.vertices[i].difference == vertex.difference) return true;
    return false;
}

/// The vertex that stands for the nearest point of the simplex; it is a point of A - B as well.
Simplex::Vertex nearest_vertex(const Simplex& simplex) {
    Simplex::Vertex sum{Vec3(0.0), Vec3(0.0), Vec3(0.0), 0.0, 1.0};
    for (size_t i = 0; i < static_cast<size_t>(simplex.count); ++i) {
        const Simplex::Vertex& vertex = simplex.vertices[i];
        sum.difference += vertex.weight * vertex.difference;
        sum.on_a += vertex.weight * vertex.on_a;
        sum.on_b += vertex.weight * vertex.on_b;
        sum.time_a += vertex.weight * vertex.time_a;
    }
    return sum;
}

/// Takes `w` into the simplex and returns its nearest point, shorter than `v` if that can be had.
Vec3 advance(Simplex& simplex, const Simplex::Vertex& w, const Vec3& v) {
    const Simplex before = simplex;
    if (simplex.count < 4 && !already_in(simplex, w)) {
        simplex.vertices[static_cast<size_t>(simplex.count++)] = w;
        const Vec3 next = reduce_to_nearest(simplex);
        if (glm::length(next) < glm::length(v)) return next;
    }
    // The simplex is so flat that its faces are rounding. The way from v to w is sound.
    simplex.vertices[0] = nearest_vertex(before);
    simplex.vertices[1] = w;
    simplex.count = 2;
    return reduce_to_nearest(simplex);
}

/// The pair of points behind the nearest point of the simplex, moved out by the margins.
void set_witness(Separation& found, const Simplex& simplex, const Vec3& v, double margin_a,
                 double margin_b) {
    const Simplex::Vertex nearest = nearest_vertex(simplex);
    found.point_a = nearest.on_a;
    found.point_b = nearest.on_b;
    found.time_a = std::clamp(nearest.time_a, 0.0, 1.0); // the weights sum to 1 but for rounding
    const double length = glm::length(v);
    if (length <= margin_a + margin_b) { // overlap: any point between the cores is in both
        const double share = margin_a + margin_b > 0.0 ? margin_a / (margin_a + margin_b) : 0.0;
        found.point_a = found.point_b = found.point_a + share * (found.point_b - found.point_a);
        return;
    }
    found.point_a -= (margin_a / length) * v;
    found.point_b += (margin_b / length) * v;
}

Separation search(const ConvexShape& a, const ConvexShape& b, const SeparationGoal& goal) {
    const double margins = a.margin + b.margin;
    Separation found;
    found.lower = 0.0;

    Simplex simplex;
    simplex.vertices[0] = support_pair(a, b, a.places[0].at - b.places[0].at + Vec3(0.1, 0.2, 0.3));
    simplex.count = 1;
    Vec3 v = reduce_to_nearest(simplex);

    for (int step = 0; step < max_steps; ++step) {
        const double length = glm::length(v);
        const double upper = length - margins <= gjk_touching ? 0.0 : length - margins;
        if (upper < found.upper) {
            found.upper = upper;
            set_witness(found, simplex, v, a.margin, b.margin);
        }
        if (found.upper == 0.0) break;

        // All of A - B lies beyond the plane through w across v: a bound for any v whatever.
        const Simplex::Vertex w = support_pair(a, b, v);
        found.lower = std::max(found.lower, glm::dot(v, w.difference) / length - margins);
        if (found.lower >= goal.limit || found.upper - found.lower <= goal.tolerance) break;
        const Vec3 next = advance(simplex, w, v);
        if (!(glm::length(next) < length)) break;
        v = next;
    }
    found.lower = std::min(found.lower, found.upper);
    return found;
}

/// Where bodies all but touch, the way between them is rounding and shows no direction. From a step
/// back it does: the nearest points found there are points of the bodies here as well, and their
/// direction gives a plane. Each round brings the direction nearer to the one across the contact:
/// over a surface of radius R an angle is left step / R times as large.
void step_back(const ConvexShape& a, const ConvexShape& b, const SeparationGoal& goal,
               Separation& found) {
    const double step =
        0.001 * std::min(glm::length(bounds(a).size()), glm::length(bounds(b).size()));
    if (!(found.upper < 0.1 * step)) return;
    Vec3 n = (found.point_a - found.point_b) / found.upper;
    for (int round = 0; round < 30 && found.upper - found.lower > goal.tolerance; ++round) {
        ConvexShape back = b;
        for (size_t i = 0; i < back.place_count; ++i) back.places[i].at -= step * n;
        Separation seen = search(a, back, {0.0, infinity});
        if (seen.upper == 0.0) return;
        const Vec3 from = n;
        n = (seen.point_a - seen.point_b) / seen.upper;
        seen.point_b += step * from;
        const double upper = glm::distance(seen.point_a, seen.point_b);
        const double lower = glm::dot(n, support_pair(a, b, n).difference) - a.margin - b.margin;
        if (upper < found.upper) {
            found.upper = upper <= gjk_touching ? 0.0 : upper;
            found.point_a = seen.point_a;
            found.point_b = found.upper == 0.0 ? seen.point_a : seen.point_b;
            found.time_a = seen.time_a;
        }
        found.lower = std::min(std::max(found.lower, lower), found.upper);
    }
}

} // namespace

Separation separation(const ConvexShape& a, const ConvexShape& b, const SeparationGoal& goal) {
    Separation found = search(a, b, goal);
    const bool is_done = found.lower >= goal.limit
                         || found.upper - found.lower <= std::max(goal.tolerance, gjk_touching);
    if (!is_done) step_back(a, b, goal, found);
    return found;
}

} // namespace core

#include "core/geom/gjk.h"

#include "core/geom/simplex.h"

namespace core {
namespace {

constexpr int max_steps = 100;

/// Nearer than this the bodies touch: a point of the simplex that should be the origin is off by
/// rounding.
constexpr double touching = 1e-10;

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

/// The pair of points behind the nearest point of the simplex, moved out by the margins.
void set_witness(Separation& found, const Simplex& simplex, const Vec3& v, double margin_a,
                 double margin_b) {
    found.point_a = found.point_b = Vec3(0.0);
    found.time_a = 0.0;
    for (size_t i = 0; i < static_cast<size_t>(simplex.count); ++i) {
        const Simplex::Vertex& vertex = simplex.vertices[i];
        found.point_a += vertex.weight * vertex.on_a;
        found.point_b += vertex.weight * vertex.on_b;
        found.time_a += vertex.weight * vertex.time_a;
    }
    const double length = glm::length(v);
    if (length <= margin_a + margin_b) { // overlap: any point between the cores is in both
        const double share = margin_a + margin_b > 0.0 ? margin_a / (margin_a + margin_b) : 0.0;
        found.point_a = found.point_b = found.point_a + share * (found.point_b - found.point_a);
        return;
    }
    found.point_a -= (margin_a / length) * v;
    found.point_b += (margin_b / length) * v;
}

} // namespace

Separation separation(const ConvexShape& a, const ConvexShape& b, const SeparationGoal& goal) {
    const double margins = a.margin + b.margin;
    Separation found;
    found.lower = 0.0;

    Simplex simplex;
    simplex.vertices[0] = support_pair(a, b, a.places[0].at - b.places[0].at + Vec3(0.1, 0.2, 0.3));
    simplex.count = 1;
    Vec3 v = reduce_to_nearest(simplex);

    for (int step = 0; step < max_steps; ++step) {
        const double length = glm::length(v);
        const double upper = length - margins <= touching ? 0.0 : length - margins;
        if (upper < found.upper) {
            found.upper = upper;
            set_witness(found, simplex, v, a.margin, b.margin);
        }
        if (found.upper == 0.0) break;

        // All of A - B lies beyond the plane through w across v: a bound for any v whatever.
        const Simplex::Vertex w = support_pair(a, b, v);
        found.lower = std::max(found.lower, glm::dot(v, w.difference) / length - margins);
        if (found.lower >= goal.limit || found.upper - found.lower <= goal.tolerance) break;
        if (simplex.count == 4 || already_in(simplex, w)) break;
        simplex.vertices[static_cast<size_t>(simplex.count++)] = w;
        v = reduce_to_nearest(simplex);
    }
    found.lower = std::min(found.lower, found.upper);
    return found;
}

} // namespace core

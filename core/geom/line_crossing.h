#pragma once

#include <array>

#include <glm/glm.hpp>

#include "core/geom/mesh.h"

namespace core {

using Vec2 = glm::dvec2;

/// Twice the signed area of the triangle a, b, c: positive counter-clockwise, negative clockwise,
/// exactly zero if the three are collinear.
///
/// Result:  the sign is exact and the value good to 1e-13 of itself, unless products of coordinates
///          overflow or underflow.
/// Source:  J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
///          Predicates, 1997.
double orientation(const Vec2& a, const Vec2& b, const Vec2& c);

/// A triangle seen along `axis`: its corners in the plane across it (the next two axes, cyclically)
/// and their positions along it.
struct ProjectedTriangle {
    std::array<Vec2, 3> corner;
    std::array<double, 3> along;
};

ProjectedTriangle project(const Triangle& triangle, int axis);

/// The contribution of an edge to the winding number of the triangle's outline around the line at
/// `p`: +1 or -1 if the edge from `a` to `b` passes on the +u side of the line, up or down; else 0.
/// The line counts as shifted by (e, e * e) for a vanishing e > 0, so it meets no edge and no
/// corner, and two triangles always agree on a shared edge.
int edge_step(const Vec2& a, const Vec2& b, const Vec2& p);

/// The winding number of the triangle's outline around the line at `p`: +1 where the line, going
/// up, leaves the body through the triangle, -1 where it enters, 0 where it misses. The sum over a
/// closed mesh is exactly 0.
int crossing_step(const ProjectedTriangle& triangle, const Vec2& p);

/// Where the line at `p` meets a triangle that it crosses, as a position along its axis.
///
/// Result:  within the extent of the triangle; good to some 1e-12 of the coordinates, however steep
///          the triangle.
double crossing_depth(const ProjectedTriangle& triangle, const Vec2& p);

} // namespace core

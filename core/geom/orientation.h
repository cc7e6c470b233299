#pragma once

#include <glm/glm.hpp>

namespace core {

using Vec2 = glm::dvec2;

/// Twice the signed area of the triangle a, b, c: positive counter-clockwise, negative clockwise,
/// zero exactly when the three lie on a line.
///
/// Result: the sign is exact and the value good to 1e-13 of itself, unless products of coordinates
///         leave the range of doubles.
/// Source: J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
///         Predicates, 1997.
double orientation(const Vec2& a, const Vec2& b, const Vec2& c);

} // namespace core

#pragma once

#include <optional>
#include <span>

#include <glm/glm.hpp>

namespace core {

/// A circle in a plane.
struct FlatCircle {
    glm::dvec2 center = glm::dvec2(0.0);
    double radius = 0.0;
    double error = 0.0; // the largest distance of a point from it
};

/// The circle for which the sum of (distance^2 - radius^2)^2 is least; empty if the points are in
/// one line. Exact, up to rounding, for points of a circle.
///
/// Source:  Kasa, A circle fitting procedure and its error analysis, 1976.
std::optional<FlatCircle> fitted_circle(std::span<const glm::dvec2> points);

} // namespace core

#include "core/geom/circle_fit.h"

#include <algorithm>
#include <cmath>

namespace core {

std::optional<FlatCircle> fitted_circle(std::span<const glm::dvec2> points) {
    if (points.size() < 3) return std::nullopt;
    const double count = static_cast<double>(points.size());
    glm::dvec2 middle(0.0);
    for (const glm::dvec2& p : points) middle += p / count;
    // The normal equations of |p|^2 = 2 c p + constant, about the middle of the points.
    double xx = 0.0, xy = 0.0, yy = 0.0, squares = 0.0;
    glm::dvec2 right(0.0);
    for (const glm::dvec2& point : points) {
        const glm::dvec2 p = point - middle;
        const double square = glm::dot(p, p);
        xx += p.x * p.x;
        xy += p.x * p.y;
        yy += p.y * p.y;
        squares += square;
        right += 0.5 * square * p;
    }
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-12 * squares * squares)) return std::nullopt;
    const glm::dvec2 center((right.x * yy - right.y * xy) / determinant,
                            (right.y * xx - right.x * xy) / determinant);
    FlatCircle circle;
    circle.center = middle + center;
    circle.radius = std::sqrt(glm::dot(center, center) + squares / count);
    for (const glm::dvec2& p : points)
        circle.error =
            std::max(circle.error, std::abs(glm::distance(p, circle.center) - circle.radius));
    return circle;
}

} // namespace core

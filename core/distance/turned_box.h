#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "core/base/vec.h"

namespace core {

/// A box round points, turned as they lie, in single precision: every point p has
/// |axis[k] . (p - origin - centre)| <= half[k], and for any unit vector u
/// |u . (p - origin - centre)| <= sum of half[k] |axis[k] . u|, although the axes are rounded.
struct TurnedBox {
    std::array<float, 3> centre{}; // from the origin given
    std::array<std::array<float, 3>, 3> axis{};
    std::array<float, 3> half{};
    float radius = 0.0F; // half the diagonal
};

/// The box of these points: along their principal axes, the axes of the frame, or a mixture of
/// both, whichever has the least surface.
TurnedBox turned_box(std::span<const Vec3> points, const Vec3& origin);

/// The box itself, its axes those of the frame.
TurnedBox turned_box(const Aabb& box, const Vec3& origin);

/// The next float that is not less.
inline float rounded_up(double x) {
    const auto f = static_cast<float>(x);
    return static_cast<double>(f) >= x ? f
                                       : std::nextafter(f, std::numeric_limits<float>::infinity());
}

} // namespace core

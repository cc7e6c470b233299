#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "core/base/vec.h"

namespace core {

/// X Y Z, the rotary A B C and the secondary U V W, in this order everywhere.
constexpr size_t axis_count = 9;
constexpr std::string_view axis_letters = "XYZABCUVW";

constexpr bool is_rotary(size_t axis) { return axis >= 3 && axis < 6; }

constexpr bool is_secondary(size_t axis) { return axis >= 6; }

/// Axis by axis; mm, and degrees of the rotary axes, as controls count them.
using AxisValues = std::array<double, axis_count>;

/// The length that a feed is counted along, given how far each axis goes: of X, Y and Z, or, when
/// these stand, of U, V and W, or of the rotary ones, in degrees.
inline double fed_length(const AxisValues& by) {
    for (const size_t first : {size_t{0}, size_t{6}, size_t{3}}) {
        const double length = glm::length(Vec3(by[first], by[first + 1], by[first + 2]));
        if (length > 0.0) return length;
    }
    return 0.0;
}

/// The same where an axis may stand anywhere: empty, nobody knows.
using AxisPosition = std::array<std::optional<double>, axis_count>;

} // namespace core

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace gcode {

/// X Y Z, the rotary A B C and the secondary U V W, in this order everywhere.
constexpr size_t axis_count = 9;
constexpr std::string_view axis_letters = "XYZABCUVW";

constexpr bool is_rotary(size_t axis) { return axis >= 3 && axis < 6; }

constexpr bool is_secondary(size_t axis) { return axis >= 6; }

/// mm, and degrees of the rotary axes.
using AxisValues = std::array<double, axis_count>;

/// mm and degrees, axis by axis; empty where nobody knows.
using Position = std::array<std::optional<double>, axis_count>;

constexpr Position zero_position = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};

} // namespace gcode

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace core {

/// X Y Z, the rotary A B C and the secondary U V W, in this order everywhere.
constexpr size_t axis_count = 9;
constexpr std::string_view axis_letters = "XYZABCUVW";

constexpr bool is_rotary(size_t axis) { return axis >= 3 && axis < 6; }

constexpr bool is_secondary(size_t axis) { return axis >= 6; }

/// Axis by axis; mm, and degrees of the rotary axes, as controls count them.
using AxisValues = std::array<double, axis_count>;

/// The same where an axis may stand anywhere: empty, nobody knows.
using AxisPosition = std::array<std::optional<double>, axis_count>;

} // namespace core

#pragma once

#include <numbers>

namespace core {

inline constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
inline constexpr double radians_per_degree = std::numbers::pi / 180.0;
inline constexpr double seconds_per_minute = 60.0;

} // namespace core

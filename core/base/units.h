#pragma once

#include <numbers>

namespace core {

inline constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
inline constexpr double radians_per_degree = std::numbers::pi / 180.0;
inline constexpr double seconds_per_minute = 60.0;
inline constexpr double mm_per_inch = 25.4;

/// An angle in degrees as radians. Not `degrees * radians_per_degree`, which differs in the last
/// bit.
constexpr double radians_of(double degrees) { return degrees * std::numbers::pi / 180.0; }

struct SinCos {
    double sin = 0.0;
    double cos = 1.0;
};

/// Sine and cosine, with the same bits on every processor and within 1 ulp of the exact value. The
/// functions of the C library differ where fused multiply-add is missing.
///
/// Units:   radians, up to 1e6 either way; beyond that, off by up to 1e-16 of the angle. NaN for an
///          angle that is not finite.
SinCos sin_cos(double angle);

/// Sine and cosine of an angle of any size in degrees. Multiples of 90 are exact.
SinCos sin_cos_deg(double angle_deg);

/// The angle of the direction (cosine, sine), in -pi..pi. The direction need not have unit length.
///
/// Result:  within 3 ulp, with the same bits everywhere; 0 for (0, 0).
double angle_of(double sine, double cosine);

} // namespace core

#pragma once

#include <cmath>
#include <cstdint>

extern "C" {
double feeler_acos(double);
double feeler_asin(double);
double feeler_atan(double);
double feeler_atan2(double, double);
double feeler_cos(double);
double feeler_exp(double);
double feeler_hypot(double, double);
double feeler_log(double);
double feeler_log10(double);
double feeler_pow(double, double);
double feeler_sin(double);
double feeler_tan(double);
}

namespace core {

// The functions of <cmath> that the standard does not round exactly, with the same bits on every
// system and processor: those of musl, within 1 ulp (`hypot`, `exp`, `log`, `pow`, `sin`, `cos`) or
// 2 ulp. Those of a system differ from version to version, and where fused multiply-add is missing.
// tests/math_functions.py refuses `std::sin` and the like elsewhere, `std::fma` (that of MinGW is
// not exact), `std::round` (that of MinGW takes 0.49999999999999994 for 0.5), and a program that
// calls the absolute value of complex numbers. `std::sqrt`, `std::fmod`, `std::remainder`,
// `std::nearbyint`, `std::trunc`, `std::floor` and `std::ceil` are exact everywhere.
//
// Source: core/base/libm/README.md.

inline double acos(double x) { return feeler_acos(x); }
inline double asin(double x) { return feeler_asin(x); }
inline double atan(double x) { return feeler_atan(x); }
inline double atan2(double y, double x) { return feeler_atan2(y, x); }
inline double cos(double x) { return feeler_cos(x); }
inline double exp(double x) { return feeler_exp(x); }
inline double hypot(double x, double y) { return feeler_hypot(x, y); }
inline double log(double x) { return feeler_log(x); }
inline double log10(double x) { return feeler_log10(x); }
inline double pow(double x, double y) { return feeler_pow(x, y); }
inline double sin(double x) { return feeler_sin(x); }
inline double tan(double x) { return feeler_tan(x); }

/// The nearest whole number; a half is rounded away from zero.
inline double round(double x) {
    const double whole = std::trunc(x); // x - whole is exact
    return std::abs(x - whole) < 0.5 ? whole : whole + std::copysign(1.0, x);
}

/// The same as an integer, at most 2^62 from 0; 0 for what is no number.
inline int64_t round_to_integer(double x) {
    constexpr double most = 0x1p62;
    return x == x ? static_cast<int64_t>(std::fmin(std::fmax(round(x), -most), most)) : 0;
}

} // namespace core

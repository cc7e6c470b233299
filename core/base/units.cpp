#include "core/base/units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace core {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A number as a sum of two, the second no larger than the rounding of the first.
struct Pair {
    double high = 0.0;
    double low = 0.0;
};

Pair exact_sum(double a, double b) {
    const double sum = a + b;
    const double part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
}

/// The upper half of a number's bits: products of two such are exact.
double upper_half(double a) {
    const double scaled = 134217729.0 * a; // 2^27 + 1
    return scaled - (scaled - a);
}

Pair exact_product(double a, double b) {
    const double product = a * b;
    const double a1 = upper_half(a), b1 = upper_half(b);
    const double a2 = a - a1, b2 = b - b1;
    return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

constexpr std::array sine_terms = {
    -1.0 / 6.0,        1.0 / 120.0,        -1.0 / 5040.0,          1.0 / 362880.0,
    -1.0 / 39916800.0, 1.0 / 6227020800.0, -1.0 / 1307674368000.0, 1.0 / 355687428096000.0};
constexpr std::array cosine_terms = {
    1.0 / 24.0,        -1.0 / 720.0,         1.0 / 40320.0,          -1.0 / 3628800.0,
    1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0, -1.0 / 6402373705728000.0};

double polynomial(const std::array<double, 8>& terms, double x) {
    double sum = 0.0;
    for (size_t i = terms.size(); i-- > 0;) sum = terms[i] + x * sum;
    return sum;
}

/// Taylor series. The truncation error is below 1e-19 for |x| <= pi / 4, and only the rounding of
/// the first term matters.
SinCos series(const Pair& x) {
    const double square = x.high * x.high, half = 0.5 * square;
    const double sine = x.high * (square * polynomial(sine_terms, square)) + x.low * (1.0 - half);
    const double near = 1.0 - half; // of the cosine, off by (1 - near) - half exactly
    const double cosine = square * (square * polynomial(cosine_terms, square)) - x.high * x.low;
    return {x.high + sine, near + (((1.0 - near) - half) + cosine)};
}

SinCos turned(const SinCos& rest, int quarters) {
    switch (quarters & 3) {
    case 0:
        return rest;
    case 1:
        return {rest.cos, -rest.sin};
    case 2:
        return {-rest.sin, -rest.cos};
    default:
        return {-rest.cos, rest.sin};
    }
}

} // namespace

SinCos sin_cos(double angle) {
    if (!std::isfinite(angle)) return {not_a_number, not_a_number};
    const double quarters = std::nearbyint(angle * 0x1.45f306dc9c883p-1);
    // A quarter turn in four parts; the first three have 33 bits, so that up to 2^20 quarters of
    // them are exact.
    Pair rest{angle - quarters * 0x1.921fb544p+0, 0.0};
    for (const double part : {0x1.0b4611a6p-34, 0x1.3198a2ep-69}) {
        const Pair next = exact_sum(rest.high, -quarters * part);
        rest = {next.high, rest.low + next.low};
    }
    rest = exact_sum(rest.high, rest.low - quarters * 0x1.b839a252049c1p-104);
    return turned(series(rest), static_cast<int>(std::fmod(quarters, 4.0)));
}

SinCos sin_cos_deg(double angle_deg) {
    if (!std::isfinite(angle_deg)) return {not_a_number, not_a_number};
    const double turn = std::remainder(angle_deg, 360.0); // this and what follows is exact
    const double quarters = std::nearbyint(turn / 90.0);
    const double rest = turn - 90.0 * quarters;
    const Pair radians = exact_product(rest, 0x1.1df46a2529d39p-6); // pi / 180 = this
    const double low = radians.low + rest * 0x1.5c1d8becdd291p-62;  // and this
    return turned(series(exact_sum(radians.high, low)), static_cast<int>(quarters));
}

double angle_of(double sine, double cosine) {
    const double s = std::abs(sine), c = std::abs(cosine);
    if (s == 0.0 && c == 0.0) return 0.0;
    const double y = std::min(s, c), x = std::max(s, c);
    const double a = y / x, a2 = a * a;
    // Good to 1e-5 (Abramowitz and Stegun 4.4.49); what is left to turn is so small that its
    // tangent has two terms.
    const double guess =
        a * (0.999866 + a2 * (-0.3302995 + a2 * (0.180141 + a2 * (-0.085133 + a2 * 0.0208351))));
    const SinCos there = sin_cos(guess);
    const double tangent = (y * there.cos - x * there.sin) / (x * there.cos + y * there.sin);
    const double rest = tangent - tangent * tangent * tangent / 3.0;

    const bool steep = s > c, back = cosine < 0.0;
    const double quarters = steep ? 1.0 : back ? 2.0 : 0.0;
    const double sign = steep != back ? -1.0 : 1.0;
    const Pair angle = exact_sum(quarters * 0x1.921fb54442d18p+0, sign * guess);
    const double low = angle.low + quarters * 0x1.1a62633145c07p-54;
    return std::copysign(angle.high + (low + sign * rest), sine);
}

} // namespace core

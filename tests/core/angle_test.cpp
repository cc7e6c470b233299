#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/base/units.h"
#include "core/base/vec.h"

namespace core {
namespace {

constexpr long double pi = std::numbers::pi_v<long double>;

/// Error of a value, in units of the last place of the true value.
double ulps(double value, long double truth) {
    const double near = std::abs(static_cast<double>(truth));
    const double ulp = std::nextafter(near, 1e300) - near;
    return std::abs(static_cast<double>((static_cast<long double>(value) - truth) / ulp));
}

TEST(SinCos, IsWithinOneUlp) {
    std::mt19937_64 rng(61);
    double worst = 0.0;
    for (const double reach : {1e-9, 0.01, 1.0, 10.0, 1000.0, 1e6}) {
        std::uniform_real_distribution<double> angle(-reach, reach);
        for (int i = 0; i < 30000; ++i) {
            const double x = angle(rng);
            const auto [s, c] = sin_cos(x);
            worst = std::max({worst, ulps(s, std::sin(static_cast<long double>(x))),
                              ulps(c, std::cos(static_cast<long double>(x)))});
        }
    }
    EXPECT_LE(worst, 1.0);
    EXPECT_GT(worst, 0.5); // no rounding is better than half, so the oracle does measure the error
}

TEST(SinCos, HoldsNextToMultiplesOfAQuarterTurn) {
    for (int quarters = -3000; quarters <= 3000; ++quarters)
        for (const double off : {0.0, 1e-15, -1e-9, 1e-5}) {
            const double x = static_cast<double>(quarters * pi / 2) + off;
            const auto [s, c] = sin_cos(x);
            EXPECT_LE(ulps(s, std::sin(static_cast<long double>(x))), 1.0) << x;
            EXPECT_LE(ulps(c, std::cos(static_cast<long double>(x))), 1.0) << x;
        }
}

TEST(SinCos, OfDegreesIsAsGood) {
    std::mt19937_64 rng(62);
    for (const double reach : {1e-6, 1.0, 45.0, 360.0}) {
        std::uniform_real_distribution<double> angle(-reach, reach);
        for (int i = 0; i < 30000; ++i) {
            const double x = angle(rng);
            const auto [s, c] = sin_cos_deg(x);
            const long double radians = x * (pi / 180);
            // Near a multiple of 90 the argument of the oracle is rounded, too.
            const double own = 1e-18 * std::abs(x);
            EXPECT_LE(std::abs(static_cast<double>(s - std::sin(radians))),
                      std::max(own, 2.3e-16 * std::abs(s)));
            EXPECT_LE(std::abs(static_cast<double>(c - std::cos(radians))),
                      std::max(own, 2.3e-16 * std::abs(c)));
        }
    }
}

TEST(SinCos, OfQuarterTurnsIsExact) {
    const double sines[] = {0, 1, 0, -1};
    for (int i = 0; i < 4000; ++i)
        for (const double turns : {0.0, 360.0, -720.0, 360e9}) {
            const auto [s, c] = sin_cos_deg(90.0 * i + turns);
            EXPECT_EQ(s, sines[i % 4]);
            EXPECT_EQ(c, sines[(i + 1) % 4]);
        }
    const Mat3 quarter = rotation_xyz_deg({90, 0, -270});
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            EXPECT_EQ(std::abs(quarter[i][j]), std::round(std::abs(quarter[i][j])));
}

TEST(SinCos, IsNoNumberForAnAngleThatIsNotFinite) {
    for (const double x : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
        EXPECT_TRUE(std::isnan(sin_cos(x).sin) && std::isnan(sin_cos(x).cos));
        EXPECT_TRUE(std::isnan(sin_cos_deg(x).sin) && std::isnan(sin_cos_deg(x).cos));
    }
}

TEST(AngleOf, IsWithinThreeUlp) {
    std::mt19937_64 rng(63);
    std::uniform_real_distribution<double> part(-1.0, 1.0), size(-30.0, 30.0);
    for (int i = 0; i < 100000; ++i) {
        const double s = part(rng) * std::pow(10.0, i % 3 ? 0.0 : size(rng));
        const double c = part(rng) * std::pow(10.0, i % 5 ? 0.0 : size(rng));
        const double angle = angle_of(s, c);
        EXPECT_LE(ulps(angle, std::atan2(static_cast<long double>(s), static_cast<long double>(c))),
                  3.0)
            << s << " " << c;
    }
    EXPECT_EQ(angle_of(0, 0), 0.0);
    EXPECT_EQ(angle_of(0, -3), std::numbers::pi);
    EXPECT_EQ(angle_of(-2, 0), -std::numbers::pi / 2);
    EXPECT_EQ(angle_of(5, 5), std::numbers::pi / 4);
}

/// Every processor must give the same bits. Also run this under
/// GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA, which disables fast functions of the C library.
TEST(SinCos, HasTheSameBitsEverywhere) {
    std::mt19937_64 rng(64); // its integers are equal on all platforms
    uint64_t hash = 14695981039346656037U;
    const auto add = [&](double x) {
        hash = (hash ^ std::bit_cast<uint64_t>(x)) * 1099511628211U;
        hash ^= hash >> 29;
    };
    for (int i = 0; i < 200000; ++i) {
        const double x = 0x1p-44 * static_cast<double>(static_cast<int64_t>(rng()));
        for (const auto& [s, c] : {sin_cos(x), sin_cos_deg(x)}) {
            add(s);
            add(c);
            add(angle_of(s, c));
        }
    }
    EXPECT_EQ(hash, 16479463538241751301U);
}

} // namespace
} // namespace core

#include <bit>
#include <cstdint>
#include <random>

#include <gtest/gtest.h>

#include "core/base/math.h"

namespace core {
namespace {

struct Function {
    const char* name;
    double (*of)(double);
    long double (*exact)(long double);
    double lowest, highest, most_ulp;
    uint64_t digest; // of the results of 20,000 arguments
};

const Function functions[] = {{"sin", sin, std::sin, -1e4, 1e4, 1.0, 0x4f0b7899d4c81ce6U},
                              {"cos", cos, std::cos, -1e4, 1e4, 1.0, 0xe0b062daa901699bU},
                              {"tan", tan, std::tan, -1e4, 1e4, 1.5, 0x7d032f8006685102U},
                              {"asin", asin, std::asin, -1.0, 1.0, 1.0, 0x1fedf959d3f4ba7cU},
                              {"acos", acos, std::acos, -1.0, 1.0, 1.0, 0xf72f6547ae8d1c34U},
                              {"atan", atan, std::atan, -50.0, 50.0, 1.0, 0xdae762bccf27cc4U},
                              {"exp", exp, std::exp, -700.0, 700.0, 1.0, 0x141ba912c4467b56U},
                              {"log", log, std::log, 1e-9, 1e9, 1.0, 0xf54063a9db36f1a1U},
                              {"log10", log10, std::log10, 1e-9, 1e9, 2.0, 0x691c7906323e625cU}};

double ulps_off(double value, long double exact) {
    const double nearest = static_cast<double>(exact);
    const double ulp = std::nextafter(std::abs(nearest), INFINITY) - std::abs(nearest);
    return static_cast<double>(std::abs(static_cast<long double>(value) - exact)) / ulp;
}

uint64_t added(uint64_t digest, double value) {
    return (digest ^ std::bit_cast<uint64_t>(value)) * 0x100000001b3U;
}

/// Uniform numbers with the same bits everywhere; those of <random> depend on the library.
class Numbers {
public:
    double in(double lowest, double highest) {
        const double share = static_cast<double>(bits_() >> 11U) * 0x1p-53;
        return lowest + share * (highest - lowest);
    }

private:
    std::mt19937_64 bits_{7};
};

/// The digests were taken from this implementation; a system or compiler on which one differs would
/// give other reports.
TEST(Math, HasTheSameBitsEverywhere) {
    for (const Function& function : functions) {
        Numbers numbers;
        uint64_t digest = 0xcbf29ce484222325U;
        for (int i = 0; i < 20000; ++i) {
            const double x = numbers.in(function.lowest, function.highest);
            digest = added(digest, function.of(x));
            ASSERT_LE(ulps_off(function.of(x), function.exact(x)), function.most_ulp)
                << function.name << " of " << x;
        }
        EXPECT_EQ(digest, function.digest) << function.name;
    }
}

TEST(Math, OfTwoArgumentsHasTheSameBitsEverywhere) {
    Numbers numbers;
    uint64_t digest = 0xcbf29ce484222325U;
    for (int i = 0; i < 20000; ++i) {
        const double x = numbers.in(-300.0, 300.0), y = numbers.in(-300.0, 300.0);
        for (const double value : {hypot(x, y), atan2(y, x), pow(std::abs(x), y / 100.0)})
            digest = added(digest, value);
        ASSERT_LE(ulps_off(hypot(x, y), std::hypot(static_cast<long double>(x), y)), 1.0);
        ASSERT_LE(ulps_off(atan2(y, x), std::atan2(static_cast<long double>(y), x)), 1.5);
    }
    EXPECT_EQ(digest, 0xb21851e4e5166444U);
}

TEST(Math, IsExactWhereTheResultIs) {
    for (int digits = -22; digits <= 22; ++digits)
        EXPECT_EQ(pow(10.0, digits), std::strtod(("1e" + std::to_string(digits)).c_str(), nullptr));
    EXPECT_EQ(hypot(0x3p600, 0x4p600), 0x5p600);
    EXPECT_EQ(hypot(0x3p-600, 0x4p-600), 0x5p-600);
    EXPECT_EQ(exp(0.0), 1.0);
    EXPECT_EQ(log10(1000.0), 3.0);
    EXPECT_TRUE(std::isnan(acos(1.1)));
    EXPECT_TRUE(std::isnan(sin(INFINITY)));
    EXPECT_EQ(atan2(0.0, -1.0), std::acos(-1.0));
}

/// Rounding is exact, so that of glibc is right.
TEST(Math, RoundsAsTheStandardSays) {
    std::mt19937_64 random(3);
    for (int i = 0; i < 200'000; ++i) {
        const double any = std::bit_cast<double>(random());
        const double half = static_cast<double>(random() % 2'000'000) * 0.5 - 500'000.0;
        for (const double x : {any, half, std::nextafter(half, 1e9), std::nextafter(half, -1e9)}) {
            if (std::isnan(x)) continue;
            ASSERT_EQ(std::bit_cast<uint64_t>(round(x)), std::bit_cast<uint64_t>(std::round(x)))
                << x;
            if (std::abs(x) < 1e18) {
                ASSERT_EQ(round_to_integer(x), std::llround(x)) << x;
            }
        }
    }
    EXPECT_EQ(round(0.7 - 0.2), 0.0);
    EXPECT_TRUE(std::isnan(round(NAN)));
    EXPECT_EQ(round_to_integer(NAN), 0);
    EXPECT_EQ(round_to_integer(INFINITY), int64_t{1} << 62);
    EXPECT_EQ(round_to_integer(-1e300), -(int64_t{1} << 62));
}

} // namespace
} // namespace core

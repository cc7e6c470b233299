#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/text.h"
#include "core/sim/run/cure_trial.h"
#include "core/sim/run/finding_text.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "core/sim/verdict.h"
#include "tests/support/random_setup.h"

namespace core {
namespace {

using testing::HasSubstr;

TEST(NumberText, HasNoTrailingZeros) {
    EXPECT_EQ(number_text(1.5, 4), "1.5");
    EXPECT_EQ(number_text(100.0, 4), "100");
    EXPECT_EQ(number_text(100.0, 0), "100");
    EXPECT_EQ(number_text(-1e-9, 6), "0");
    EXPECT_EQ(number_text(-0.00005, 6), "-0.00005");
}

TEST(NumberText, RoundsAsTheLibraryOfFormatsDoes) {
    std::mt19937_64 random(20261126);
    const auto check = [](double value, int decimals) {
        std::string plain = without_trailing_zeros(fmt::format("{:.{}f}", value, decimals));
        if (plain == "-0") plain = "0";
        ASSERT_EQ(number_text(value, decimals), plain) << decimals;
    };
    for (const int decimals : {0, 1, 3, 4, 6, 9, 12}) {
        for (int i = 0; i < 20'000; ++i) {
            // Of any size, multiples of a tenth or an eighth of the last decimal, or next to one.
            const double size = std::ldexp(1.0, static_cast<int>(random() % 80) - 40);
            check(size * (static_cast<double>(random() >> 11U) * 0x1p-53 - 0.5), decimals);
            double near = static_cast<double>(random() % 2'000'000) - 1e6;
            for (int k = 0; k < decimals; ++k) near /= 10.0;
            near /= random() % 2 ? 10.0 : 8.0;
            for (const double value : {near, std::nextafter(near, 1e9), std::nextafter(near, -1e9)})
                check(value, decimals);
        }
        for (const double value : {0.0, -0.0, 0.5, 1.5, 2.5, -0.5, 0.0000005, 1e300, -1e15,
                                   999999.9999995, std::numeric_limits<double>::infinity()})
            check(value, decimals);
    }
}

TEST(BoundText, ShowsNoLowerBoundLargerThanItIs) {
    EXPECT_EQ(at_least(1.9996), "1.999");
    EXPECT_EQ(at_least(2.0000000001), "2.000");
    EXPECT_EQ(at_least(-0.0004), "-0.001");
    EXPECT_EQ(at_least(0.0004), "0.000");
    EXPECT_EQ(at_least(49.6, 0), "49");
    EXPECT_EQ(at_least(0.29, 2), "0.29") << "29 cents are less than that in binary";
    EXPECT_EQ(at_least(1234.5678, 9), "1234.567800000");
}

TEST(BoundText, ShowsNoUpperBoundSmallerThanItIs) {
    EXPECT_EQ(at_most(1.9996), "2.000");
    EXPECT_EQ(at_most(2.0001), "2.001");
    EXPECT_EQ(at_most(-0.0004), "0.000") << "and not -0.000";
    EXPECT_EQ(at_most(0.1 + 0.2, 1), "0.3");
    EXPECT_EQ(at_most(1e-7), "0.000");
}

TEST(BoundText, TakesRoundingForNothing) {
    EXPECT_EQ(at_least(1.9999999999), "2.000");
    EXPECT_EQ(at_most(2.0000000001), "2.000");
    EXPECT_EQ(at_least(1.999999), "1.999")
        << "a number below it by more than half the resolution is not";
    EXPECT_EQ(at_most(2.000001), "2.001");
}

TEST(BoundText, NeverShowsASmallerClearanceAsTheMinimum) {
    test_support::Dice dice{std::mt19937(20261122)};
    size_t ties = 0;
    for (int i = 0; i < 20'000; ++i) {
        const double keep =
            dice.chance(0.5) ? std::round(dice.between(0.0, 9e3)) * 1e-3 : dice.between(0.0, 9.0);
        const double upper = keep - 1.001e-6 - std::pow(10.0, dice.between(-12.0, -2.0));
        for (const int digits : {0, 1, 2, 3, 6}) {
            const double near = units_below(upper, digits), far = units_above(keep, digits);
            ASSERT_LT(near, far) << upper << " of " << keep << " with " << digits;
            ties += far - near == 1.0;
        }
        const int digits = digits_below(upper, keep);
        EXPECT_LT(units_above(upper, digits), units_above(keep, digits)) << upper << " of " << keep;
    }
    EXPECT_GT(ties, 20'000U) << "as near to each other as they can be";
}

TEST(BoundText, IsOneNumberWhereBothBoundsAre) {
    EXPECT_EQ(bounds_text(1.9996, 1.9996, "-"), "1.999");
    EXPECT_EQ(bounds_text(1.9996, 2.0024, " to "), "1.999 to 2.003");
    EXPECT_EQ(bounds_text(-2e-6, 0.0, "-"), "0.000");
    EXPECT_EQ(missing_text(0.0004, 0.0004, "-"), "0.001");
    EXPECT_EQ(missing_text(0.0004, 0.1004, "-"), "0.000-0.101");
    EXPECT_EQ(bounds_below(1.9, 1.9996, 2.0, "-"), "1.900-1.999600");
    EXPECT_EQ(bounds_below(1.9, 2.0004, 2.0, "-"), "1.900-2.001");
}

TEST(BoundText, HasSoManyFigures) {
    EXPECT_EQ(at_most_figures(0.0151, 2), "0.016");
    EXPECT_EQ(at_most_figures(0.0100000001, 2), "0.01");
    EXPECT_EQ(at_most_figures(0.0999, 2), "0.1");
    EXPECT_EQ(at_most_figures(1234.5, 2), "1235");
    EXPECT_EQ(at_most_figures(20.0, 3), "20");
    EXPECT_EQ(at_most_figures(0.0, 3), "0");
}

TEST(BoundText, ShowsNoClearanceBelowNothing) {
    EXPECT_EQ(clearance_at_least(-0.0004), "0.000");
    EXPECT_EQ(clearance_at_least(1.9996), "1.999");
}

Finding near_miss(double lower, double upper, double keep) {
    PairClearance pair;
    pair.allowance.distance = keep;
    pair.lower = lower;
    pair.upper = upper;
    pair.verdict = judge_distance(pair.allowance, lower, upper);
    return finding_of({}, pair, {.motion = BlockMotion::feed}, {}, {});
}

TEST(FindingText, ShowsTheClearanceBelowTheMinimum) {
    EXPECT_THAT(
        near_miss(1.2346, 1.2346, 2.0).message,
        HasSubstr("within 1.234 mm of the stock (minimum clearance 2.000 mm; short by 0.766 mm)"));
    EXPECT_THAT(
        near_miss(1.9996, 1.9996, 2.0).message,
        HasSubstr(
            "within 1.999600 mm of the stock (minimum clearance 2.000 mm; short by 0.000400 mm)"));
    EXPECT_THAT(
        near_miss(1.9, 1.9996, 2.0).message,
        HasSubstr("within 1.900000 to 1.999600 mm of the stock (minimum clearance 2.000 mm"));
    EXPECT_THAT(near_miss(2.0002, 2.0002, 2.0004).message, HasSubstr("minimum clearance 2.001 mm"));
}

TEST(FindingText, SaysHowNearItMayBeWithoutComingNearerThanThat) {
    EXPECT_THAT(near_miss(1.9996, 2.5, 2.0).message,
                HasSubstr("within 1.999 mm of the stock (minimum clearance 2.000 mm)"));
    EXPECT_THAT(near_miss(1.999998, 2.5, 2.0).message,
                HasSubstr("within 1.999 mm of the stock (minimum clearance 2.000 mm)"));
}

} // namespace
} // namespace core

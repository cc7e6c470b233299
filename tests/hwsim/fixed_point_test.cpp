#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "hwsim/registers.h"
#include "hwsim/search.h"

namespace hwsim {
namespace {

constexpr double step = lsb;
const double just_less = 1.0 - 0x1p-53;

int32_t nearest(double length) { return fixed(length, Rounding::nearest).value(); }
int32_t down(double length) { return fixed(length, Rounding::down).value(); }
int32_t up(double length) { return fixed(length, Rounding::up).value(); }

TEST(FixedPoint, KeepsWholeStepsAsTheyAre) {
    for (int32_t steps = least_coordinate; steps <= greatest_coordinate; steps += 977)
        for (const Rounding rounding : {Rounding::nearest, Rounding::down, Rounding::up})
            ASSERT_EQ(fixed(steps * step, rounding).value(), steps);
}

TEST(FixedPoint, TakesTiesAwayFromZero) {
    EXPECT_EQ(nearest(0.5 * step), 1);
    EXPECT_EQ(nearest(-0.5 * step), -1);
    EXPECT_EQ(nearest(1.5 * step), 2);
    EXPECT_EQ(nearest(-2.5 * step), -3);
}

TEST(FixedPoint, LooksOnTheRightSideOfATie) {
    EXPECT_EQ(nearest(0.5 * just_less * step), 0);
    EXPECT_EQ(nearest(-0.5 * just_less * step), 0);
    EXPECT_EQ(nearest(std::nextafter(0.5, 1.0) * step), 1);
    EXPECT_EQ(nearest(std::nextafter(4095.5, 0.0) * step), 4095);
    EXPECT_EQ(nearest(std::nextafter(8388606.5, 0.0) * step), 8388606);
}

TEST(FixedPoint, LeavesNothingOutsideWhenItRoundsOutwards) {
    const double least = std::numeric_limits<double>::denorm_min();
    EXPECT_EQ(down(-least), -1);
    EXPECT_EQ(down(least), 0);
    EXPECT_EQ(up(least), 1);
    EXPECT_EQ(up(-least), 0);
    EXPECT_EQ(up(std::nextafter(step, 1.0)), 2);
    EXPECT_EQ(down(std::nextafter(step, 0.0)), 0);
}

TEST(FixedPoint, IsOffByNoMoreThanItSays) {
    std::mt19937_64 rng(1);
    std::uniform_real_distribution<double> any(-2047.9, 2047.9), near_a_tie(-0x1p-30, 0x1p-30);
    for (int i = 0; i < 100'000; ++i) {
        double length = any(rng);
        if (i % 2 == 0) length = (std::floor(length / step) + 0.5) * step + near_a_tie(rng);
        // Exact: both are multiples of 2^-42 within 2^11.
        ASSERT_LE(std::abs(length_of(nearest(length)) - length), 0.5 * step);
        ASSERT_LE(length_of(down(length)), length);
        ASSERT_GT(length_of(down(length)) + step, length);
        ASSERT_GE(length_of(up(length)), length);
        ASSERT_LT(length_of(up(length)) - step, length);
    }
}

TEST(FixedPoint, RefusesWhatDoesNotFit) {
    const double past_the_top = greatest_coordinate * step + 0.5 * step;
    const double past_the_bottom = least_coordinate * step - 0.5 * step;
    EXPECT_FALSE(fixed(past_the_top, Rounding::nearest));
    EXPECT_EQ(nearest(std::nextafter(past_the_top, 0.0)), greatest_coordinate);
    EXPECT_EQ(down(past_the_top), greatest_coordinate);
    EXPECT_FALSE(fixed(past_the_top, Rounding::up));
    EXPECT_FALSE(fixed(past_the_bottom, Rounding::nearest));
    EXPECT_EQ(nearest(std::nextafter(past_the_bottom, 0.0)), least_coordinate);
    EXPECT_EQ(up(past_the_bottom), least_coordinate);
    EXPECT_FALSE(fixed(past_the_bottom, Rounding::down));
    const double infinite = std::numeric_limits<double>::infinity();
    for (const double none : {std::nan(""), infinite, -infinite, 1e300, -1e300})
        for (const Rounding rounding : {Rounding::nearest, Rounding::down, Rounding::up})
            EXPECT_FALSE(fixed(none, rounding));
    EXPECT_NE(fixed(3000.0, Rounding::up).error().message.find("3000"), std::string::npos);
}

TEST(Threshold, IsNeverLessThanTheDistanceAndHalfTheStepAcross) {
    std::mt19937_64 rng(2);
    std::uniform_real_distribution<double> any(0.0, 5.0);
    for (int i = 0; i < 100'000; ++i) {
        const double distance = any(rng), sample_step = any(rng) / 8.0;
        const double kept =
            length_of(static_cast<int32_t>(threshold(distance, sample_step).value()));
        const double square = distance * distance + 0.25 * sample_step * sample_step;
        ASSERT_GE(kept * kept, square * (1.0 - 1e-15));
        ASSERT_LT((kept - step) * (kept - step), square * (1.0 + 1e-15));
    }
    EXPECT_EQ(threshold(0.0, 0.0).value(), 0U);
    EXPECT_EQ(threshold(1.0, 0.0).value(), 4096U);
    EXPECT_EQ(threshold(std::nextafter(1.0, 2.0), 0.0).value(), 4097U);
}

TEST(Threshold, RefusesInvalidLengths) {
    EXPECT_FALSE(threshold(-1e-9, 0.0));
    EXPECT_FALSE(threshold(0.0, -1e-9));
    EXPECT_FALSE(threshold(std::nan(""), 0.0));
    EXPECT_FALSE(threshold(0.0, std::nan("")));
    EXPECT_FALSE(threshold(2048.0, 0.0));
}

} // namespace
} // namespace hwsim

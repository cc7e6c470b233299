#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/geom/line_crossing.h"

namespace core {
namespace {

__extension__ using Whole = __int128;

int sign_of(double x) { return (x > 0.0) - (x < 0.0); }

/// The sign for coordinates that are multiples of 2^-50 up to 32, computed with integers.
int exact_sign(const Vec2& a, const Vec2& b, const Vec2& c) {
    const auto whole = [](double x) { return static_cast<Whole>(std::ldexp(x, 50)); };
    const Whole left = (whole(a.x) - whole(c.x)) * (whole(b.y) - whole(c.y));
    const Whole right = (whole(a.y) - whole(c.y)) * (whole(b.x) - whole(c.x));
    return (left > right) - (left < right);
}

TEST(Orientation, HasTheRightSignNextToALine) {
    std::mt19937 rng(9);
    std::uniform_int_distribution<int> step(-16, 16);
    int on_line = 0, wrong_in_doubles = 0;
    for (int i = 0; i < 20000; ++i) {
        // Kettner's example: points near (0.5, 0.5) and a line that they almost lie on.
        const Vec2 a(0.5 + step(rng) * 0x1p-50, 0.5 + step(rng) * 0x1p-50);
        const Vec2 b(12.0, 12.0), c(24.0, 24.0);
        const int expected = exact_sign(a, b, c);
        ASSERT_EQ(sign_of(orientation(a, b, c)), expected);
        ASSERT_EQ(sign_of(orientation(b, c, a)), expected);
        ASSERT_EQ(sign_of(orientation(c, b, a)), -expected);
        const double naive = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        wrong_in_doubles += sign_of(naive) != expected;
        on_line += expected == 0;
    }
    EXPECT_GT(on_line, 100);
    EXPECT_GT(wrong_in_doubles, 100); // otherwise the sample would not need the exact part
}

TEST(Orientation, IsTwiceTheArea) {
    EXPECT_EQ(orientation({0.0, 0.0}, {4.0, 0.0}, {0.0, 3.0}), 12.0);
    EXPECT_EQ(orientation({0.0, 0.0}, {0.0, 3.0}, {4.0, 0.0}), -12.0);
    EXPECT_EQ(orientation({0.1, 0.1}, {0.2, 0.2}, {0.4, 0.4}), 0.0);
    EXPECT_EQ(orientation({0.0, 0.0}, {1e6, 1e6}, {1.0, 1.0 + 0x1p-52}), 1e6 * 0x1p-52);
}

} // namespace
} // namespace core

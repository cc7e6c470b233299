#include <random>

#include <gtest/gtest.h>

#include "hwsim/registers.h"
#include "hwsim/search.h"
#include "tests/hwsim/random_models.h"

namespace hwsim {
namespace {

TEST(Interpolation, BeginsAtTheStartAndEndsAtTheEnd) {
    std::mt19937 rng(1);
    for (int i = 0; i < 2'000; ++i) {
        const Segment s = random_segment(rng, 8'388'607, static_cast<uint8_t>(rng() % 13));
        ASSERT_EQ(offset_at(s, 0), s.start);
        ASSERT_EQ(offset_at(s, 1U << s.log2_steps), s.end);
    }
}

TEST(Interpolation, IsOffByHalfAStepAtMostAndNeverTurnsBack) {
    std::mt19937 rng(2);
    for (int i = 0; i < 200; ++i) {
        const Segment s = random_segment(rng, i % 2 ? 8'388'607 : 40, 9);
        FixedVec before = s.start;
        for (uint32_t k = 0; k <= 512; ++k) {
            const FixedVec at = offset_at(s, k);
            for (size_t axis = 0; axis < 3; ++axis) {
                const int64_t way = int64_t{s.end[axis]} - s.start[axis];
                const int64_t off = (int64_t{at[axis]} - s.start[axis]) * 512 - int64_t{k} * way;
                ASSERT_LE(std::abs(off), 256);
                ASSERT_GE((at[axis] - before[axis]) * (way < 0 ? -1 : 1), 0);
            }
            before = at;
        }
    }
}

TEST(RootUp, IsTheLeastIntegerWhoseSquareIsEnough) {
    for (int64_t r = 1; r < (1 << 25); r += r < 3000 ? 1 : 9'973) {
        ASSERT_EQ(root_up(r * r - 1), r == 1 ? 0 : r);
        ASSERT_EQ(root_up(r * r), r);
        ASSERT_EQ(root_up(r * r + 1), r + 1);
    }
    EXPECT_EQ(root_up(0), 0);
}

/// No box round the records, swept over the samples, is farther away than they are.
TEST(BoxTest, IsNeverMoreThanTheDistanceOfWhatIsInside) {
    std::mt19937 rng(3);
    int apart = 0;
    for (int i = 0; i < 200'000; ++i) {
        const int32_t reach = i % 2 ? 6 : 100'000;
        const Record tool = random_record(rng, reach), work = random_record(rng, reach);
        const Segment s = random_segment(rng, reach, 3);
        const uint32_t first = rng() % 5, last = first + rng() % 4;
        const auto gap = squared_gap(volume_of(tool, Side::tool), offset_at(s, first),
                                     offset_at(s, last), box_of(work));
        ASSERT_TRUE(gap);
        for (uint32_t k = first; k <= last; ++k)
            ASSERT_LE(*gap, squared_distance(tool, offset_at(s, k), work));
        apart += *gap > 0 ? 1 : 0;
    }
    EXPECT_GT(apart, 50'000);
}

TEST(BoxTest, SaysNothingBeyondTheRange) {
    const Volume box{{{-10, -10, -10}, {10, 10, 10}}, 0};
    const FixedVec here{0, 0, 0}, high{0, greatest_coordinate - 10, 0},
        higher{0, greatest_coordinate - 9, 0}, low{0, 0, least_coordinate + 10},
        lower{0, 0, least_coordinate + 9};
    EXPECT_TRUE(squared_gap(box, here, high, everywhere));
    EXPECT_FALSE(squared_gap(box, here, higher, everywhere));
    EXPECT_FALSE(squared_gap(box, higher, here, everywhere));
    EXPECT_TRUE(squared_gap(box, low, here, everywhere));
    EXPECT_FALSE(squared_gap(box, lower, here, everywhere));
    // A radius reaches sideways only.
    const Volume disc{{{0, 0, 0}, {0, 0, 0}}, 10};
    EXPECT_TRUE(squared_gap(disc, here, {0, 0, greatest_coordinate}, everywhere));
    EXPECT_TRUE(squared_gap(disc, here, high, everywhere));
    EXPECT_FALSE(squared_gap(disc, here, higher, everywhere));
}

/// The distance of a cylinder to a post, by doubles, for the true one is known in closed form.
TEST(PairDistance, IsTrueButForOneStepOfTheRoot) {
    std::mt19937 rng(4);
    for (int i = 0; i < 100'000; ++i) {
        const int32_t reach = i % 2 ? 8 : 3'000'000;
        const Record tool = random_record(rng, reach), work = random_record(rng, reach);
        const FixedVec o{static_cast<int32_t>(rng() % 100), 0, -7};
        const auto beside = [](double x, double half) { return std::max(std::abs(x) - half, 0.0); };
        const double dx = beside(double(tool.base[0]) + o[0] - work.base[0], work.half);
        const double dy = beside(double(tool.base[1]) + o[1] - work.base[1], work.half);
        const double middle = tool.base[2] + o[2] + 0.5 * tool.run - work.base[2] - 0.5 * work.run;
        const double dz = beside(middle, 0.5 * (tool.run + work.run));
        const double r = std::max(std::hypot(dx, dy) - tool.half, 0.0);
        const double truth = std::hypot(r, dz);
        const double found = std::sqrt(double(squared_distance(tool, o, work)));
        ASSERT_GE(found, truth - 1e-6);
        ASSERT_LT(found, truth + (tool.half > 0 ? 1.0 : 1e-6));
    }
}

TEST(PairDistance, OfBarePointsIsExact) {
    const Record tool{{3, 4, 12}, 0, 0}, work{};
    EXPECT_EQ(squared_distance(tool, {0, 0, 0}, work), 169U);
    const Record corner{everywhere.min, 0, 0}, other{everywhere.max, 0, 0};
    const uint64_t side = (1U << 24) - 1;
    EXPECT_EQ(squared_distance(corner, {0, 0, 0}, other), 3 * side * side);
    EXPECT_LT(3 * side * side, beyond_all_squares);
}

} // namespace
} // namespace hwsim

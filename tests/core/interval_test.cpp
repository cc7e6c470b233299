#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/dbm/interval.h"

namespace core {
namespace {

/// A slow oracle: unit cells that are filled or empty.
class Bitmap {
public:
    double set(int lower, int upper, bool value) {
        double changed = 0.0;
        for (int i = lower; i < upper; ++i) {
            changed += cells_[static_cast<size_t>(i)] != value;
            cells_[static_cast<size_t>(i)] = value;
        }
        return changed;
    }

    std::vector<Interval> intervals() const {
        std::vector<Interval> found;
        for (size_t i = 0; i < cells_.size(); ++i) {
            if (!cells_[i]) continue;
            const auto at = static_cast<double>(i);
            if (found.empty() || found.back().upper != at) found.push_back({at, at});
            found.back().upper = at + 1.0;
        }
        return found;
    }

private:
    std::vector<bool> cells_ = std::vector<bool>(64);
};

TEST(IntervalList, AgreesWithABitmap) {
    std::mt19937 rng(42);
    std::uniform_int_distribution<int> position(0, 64), kind(0, 2);
    size_t most = 0;
    for (int round = 0; round < 300; ++round) {
        IntervalList list;
        Bitmap bitmap;
        for (int step = 0; step < 60; ++step) {
            const int a = position(rng), b = std::min(64, a + position(rng) / 6);
            const Interval interval{static_cast<double>(a), static_cast<double>(b)};
            if (kind(rng) == 0) {
                EXPECT_EQ(list.subtract(interval), bitmap.set(a, b, false));
            } else {
                list.add(interval);
                bitmap.set(a, b, true);
            }
            const std::vector<Interval> expected = bitmap.intervals();
            ASSERT_EQ(std::vector<Interval>(list.begin(), list.end()), expected);
            most = std::max(most, list.size());
        }
    }
    EXPECT_GE(most, 8u); // so the heap and moves within it were exercised
}

TEST(IntervalList, UnitesWhatTouches) {
    IntervalList list(Interval{0.0, 1.0});
    list.add({1.0, 2.0});
    list.add({-1.0, 0.0});
    EXPECT_EQ(list, IntervalList(Interval{-1.0, 2.0}));
}

TEST(IntervalList, IgnoresEmptyIntervals) {
    IntervalList list(Interval{0.0, 4.0});
    list.add({9.0, 9.0});
    list.add({9.0, 8.0});
    EXPECT_EQ(list.subtract({2.0, 2.0}), 0.0);
    EXPECT_EQ(list.subtract({3.0, 1.0}), 0.0);
    EXPECT_EQ(list, IntervalList(Interval{0.0, 4.0}));
    EXPECT_TRUE(IntervalList(Interval{1.0, 1.0}).empty());
}

TEST(IntervalList, ReturnsTheLengthThatWasReallyThere) {
    IntervalList list(Interval{0.0, 4.0});
    list.add({6.0, 7.0});
    EXPECT_EQ(list.subtract({3.0, 6.5}), 1.5);
    EXPECT_EQ(list.subtract({3.0, 6.5}), 0.0);
    EXPECT_EQ(LineView(list).length(), 3.5);
    EXPECT_EQ(list.subtract({-INFINITY, INFINITY}), 3.5);
    EXPECT_TRUE(list.empty());
}

TEST(IntervalList, HoldsItsEnds) {
    IntervalList list(Interval{0.0, 1.0});
    list.add({3.0, 4.0});
    for (const double x : {0.0, 0.5, 1.0, 3.0, 4.0}) EXPECT_TRUE(list.contains(x)) << x;
    for (const double x : {-0.1, 1.1, 2.9, 4.1}) EXPECT_FALSE(list.contains(x)) << x;
}

TEST(IntervalList, CopiesAndMovesWithWhatItHolds) {
    IntervalList one(Interval{0.0, 1.0}), three(Interval{0.0, 1.0});
    three.add({2.0, 3.0});
    three.add({4.0, 5.0});
    IntervalList copy = three;
    copy.subtract({0.0, 9.0});
    EXPECT_EQ(three.size(), 3u);
    copy = three;
    EXPECT_EQ(copy, three);
    copy = one;
    EXPECT_EQ(copy, one);
    IntervalList taken = std::move(three);
    EXPECT_EQ(taken.size(), 3u);
    taken = std::move(one);
    EXPECT_EQ(taken, IntervalList(Interval{0.0, 1.0}));
    IntervalList& self = taken;
    taken = self;
    EXPECT_EQ(taken.size(), 1u);
}

} // namespace
} // namespace core

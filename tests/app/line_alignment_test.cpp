#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "app/library/result/program_diff.h"

namespace {

using Items = std::vector<uint32_t>;
using Pairs = std::vector<std::pair<size_t, size_t>>;

Items items(const std::string& text) { return {text.begin(), text.end()}; }

/// The length of the longest common subsequence, by dynamic programming.
size_t most_common(const Items& a, const Items& b) {
    std::vector<std::vector<size_t>> best(a.size() + 1, std::vector<size_t>(b.size() + 1, 0));
    for (size_t i = 0; i < a.size(); ++i)
        for (size_t j = 0; j < b.size(); ++j)
            best[i + 1][j + 1] =
                a[i] == b[j] ? best[i][j] + 1 : std::max(best[i][j + 1], best[i + 1][j]);
    return best[a.size()][b.size()];
}

void expect_sound(const Items& a, const Items& b, const Pairs& pairs) {
    for (size_t i = 0; i < pairs.size(); ++i) {
        ASSERT_LT(pairs[i].first, a.size());
        ASSERT_LT(pairs[i].second, b.size());
        ASSERT_EQ(a[pairs[i].first], b[pairs[i].second]);
        if (i == 0) continue;
        ASSERT_LT(pairs[i - 1].first, pairs[i].first);
        ASSERT_LT(pairs[i - 1].second, pairs[i].second);
    }
}

TEST(Aligned, KeepsWhatIsCommon) {
    EXPECT_EQ(app::aligned(items("abc"), items("abc")), (Pairs{{0, 0}, {1, 1}, {2, 2}}));
    EXPECT_EQ(app::aligned(items("abc"), items("axc")), (Pairs{{0, 0}, {2, 2}}));
    EXPECT_EQ(app::aligned(items("abc"), items("abxyc")), (Pairs{{0, 0}, {1, 1}, {2, 4}}));
    EXPECT_EQ(app::aligned(items("abc"), items("xyz")), Pairs{});
    EXPECT_EQ(app::aligned({}, items("x")), Pairs{});
    EXPECT_EQ(app::aligned({}, {}), Pairs{});
}

TEST(Aligned, FindsAsManyAsThereCanBe) {
    std::mt19937 random(3);
    size_t with_differences = 0;
    for (int round = 0; round < 2000; ++round) {
        Items a(random() % 40), b(random() % 40);
        const uint32_t letters = 2 + random() % 6;
        for (uint32_t& item : a) item = random() % letters;
        for (uint32_t& item : b) item = random() % letters;
        const Pairs pairs = app::aligned(a, b);
        expect_sound(a, b, pairs);
        ASSERT_EQ(pairs.size(), most_common(a, b));
        with_differences += pairs.size() < std::min(a.size(), b.size());
    }
    EXPECT_GT(with_differences, 1000u);
}

TEST(Aligned, FollowsAFewChangesInALongList) {
    Items a(200'000);
    std::mt19937 random(5);
    for (uint32_t& item : a) item = random() % 50;
    Items b = a;
    for (int change = 0; change < 200; ++change) {
        const size_t place = random() % b.size();
        if (change % 3 == 0)
            b.insert(b.begin() + place, 7);
        else if (change % 3 == 1)
            b.erase(b.begin() + place);
        else
            b[place] = 1000;
    }
    const Pairs pairs = app::aligned(a, b);
    expect_sound(a, b, pairs);
    EXPECT_GE(pairs.size(), a.size() - 200);
}

/// Lists with the same items in a completely different order.
TEST(Aligned, GivesUpTheMostInTimeWhenAllIsOther) {
    Items a(50'000);
    std::mt19937 random(9);
    for (size_t i = 0; i < a.size(); ++i) a[i] = static_cast<uint32_t>(i);
    Items b = a;
    std::shuffle(b.begin(), b.end(), random);
    const Pairs pairs = app::aligned(a, b);
    expect_sound(a, b, pairs);
    EXPECT_GT(pairs.size(), 20u);
}

} // namespace

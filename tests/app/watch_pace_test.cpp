#include <gtest/gtest.h>

#include "app/library/watch/watched_files.h"

namespace app {
namespace {

using namespace std::chrono_literals;

/// A watch whose scans take a negligible time.
class WatchPaceTest : public testing::Test {
protected:
    bool is_time_after(WatchPace::Clock::duration time, const WatchedFiles::Change& change) {
        return pace.is_time(change, begin + time, 1ms);
    }

    const WatchPace::Clock::time_point begin{};
    const WatchedFiles::Change nothing, settled{.paths = {"a.nc"}},
        written{.paths = {"a.nc"}, .are_files_settled = false},
        busy{.paths = {"a.nc"}, .are_names_settled = false};
    WatchPace pace{begin};
};

TEST_F(WatchPaceTest, LooksForATwentiethOfTheTimeAtMost) {
    for (const auto took : {1ms, 10ms, 500ms, 20'000ms}) {
        pace.is_time(nothing, begin, took);
        EXPECT_GE(pace.pause(), 19 * took);
        EXPECT_LE(pace.pause(), std::max<WatchPace::Clock::duration>(200ms, 20 * took));
        EXPECT_GE(pace.pause(), 200ms);
    }
}

TEST_F(WatchPaceTest, ChecksWhatHasChangedAtOnceWhenItHasSettled) {
    EXPECT_FALSE(is_time_after(1s, nothing));
    EXPECT_TRUE(is_time_after(2s, settled));
}

TEST_F(WatchPaceTest, WaitsForWhoeverWritesButNotForEver) {
    EXPECT_FALSE(is_time_after(1s, nothing));
    for (int second = 2; second <= 31; ++second)
        EXPECT_FALSE(is_time_after(std::chrono::seconds(second), written)) << second;
    EXPECT_TRUE(is_time_after(32s, written));
}

TEST_F(WatchPaceTest, WaitsLessForNamesThatComeAndGo) {
    EXPECT_FALSE(is_time_after(1s, busy));
    EXPECT_FALSE(is_time_after(2s, busy));
    EXPECT_TRUE(is_time_after(3s, busy));
}

TEST_F(WatchPaceTest, CountsFromTheLastLookThatFoundNothing) {
    EXPECT_FALSE(is_time_after(60s, nothing));
    EXPECT_FALSE(is_time_after(61s, written));
    EXPECT_FALSE(is_time_after(62s, nothing)) << "all is as it was again";
    EXPECT_FALSE(is_time_after(91s, written));
    EXPECT_TRUE(is_time_after(93s, written));
}

} // namespace
} // namespace app

#include <atomic>
#include <random>
#include <thread>

#include "app/base/stopwatch.h"
#include "tests/app/store_life.h"
#include "tests/app/thousand_results.h"

namespace {

using namespace std::chrono_literals;
using app::ResultStore;
using app::Stopwatch;
using store_life::count_in;
using store_life::expect_intact;
using store_life::killed;
using store_life::Last;
using store_life::Life;
using store_life::ThousandResults;
using test_support::ScopedFolder;

TEST(StoreSpeed, FindsAThousandResultsInASecond) {
    const ThousandResults results;
    results.keep_all();
    const Stopwatch watch;
    results.find_all();
    EXPECT_LT(watch.seconds(), 1.0);
}

/// On a slow disk one transaction for each result took ten times as long.
TEST(StoreSpeed, KeepsAThousandResultsInASecond) {
    const ThousandResults results;
    const Stopwatch watch;
    results.keep_all();
    EXPECT_LT(watch.seconds(), 1.0);
}

TEST(StoreSpeed, WritesAResultWithinASecondWithoutAFlush) {
    const ScopedFolder folder;
    const auto each = store_life::numbered(folder.write("a.nc", "G0 X1\n"), 1);
    auto store = ResultStore::open(folder / "db", "1");
    ASSERT_TRUE(store);
    const Stopwatch watch;
    ASSERT_TRUE(store->keep(each.job, each.run, each.result));
    const auto found = [&] { return *ResultStore::open(folder / "db", "1")->find(each.job); };
    while (found() != each.result && watch.seconds() < 5.0) std::this_thread::sleep_for(10ms);
    EXPECT_EQ(found(), each.result);
    EXPECT_LT(watch.seconds(), 1.0);
}

TEST(StoreSpeed, GivesUpALockedDatabaseWithinTenSecondsInAllAndOneWhenStopped) {
    const ScopedFolder folder;
    const auto each = store_life::numbered(folder.write("a.nc", "G0 X1\n"), 1);
    std::atomic<bool> is_stopped = false;
    auto store = ResultStore::open(
        folder / "db", "1", std::make_shared<app::RetryBudget>([&] { return is_stopped.load(); }));
    ASSERT_TRUE(store);
    auto other = app::Database::open(folder / "db", app::Database::Access::read_write);
    ASSERT_TRUE(other && other->run("BEGIN EXCLUSIVE"));
    ASSERT_TRUE(store->keep(each.job, each.run, each.result));
    const Stopwatch watch;
    EXPECT_FALSE(store->find(each.job));
    EXPECT_FALSE(store->flush());
    EXPECT_FALSE(store->keep(each.job, each.run, each.result));
    EXPECT_GT(watch.seconds(), 3.0);
    EXPECT_LT(watch.seconds(), 12.0);
    is_stopped = true;
    const Stopwatch stopping;
    EXPECT_FALSE(store->find(each.job));
    EXPECT_LT(stopping.seconds(), 2.0);
}

TEST(StoreSpeed, LosesAtAKillNothingOlderThanASecond) {
    const ScopedFolder folder;
    const std::string program = folder.write("a.nc", "G0 X1\n");
    std::mt19937 random(8);
    int next = 0, lost = 0, kept_by_time = 0;
    for (int kill = 0; kill < 8; ++kill) {
        const Life life{false, true, static_cast<useconds_t>(random() % 500'000 + 900'000)};
        const Last last = killed(life, folder / "db", program, next);
        ASSERT_GE(last.number, next - 1) << "it could not store a result";
        auto store = ResultStore::open(folder / "db", "1");
        ASSERT_TRUE(store) << store.error().message;
        const int count = count_in(*store, program, last.number + 3);
        EXPECT_GE(count, last.second_before + 1);
        EXPECT_LE(count, last.number + 2);
        lost += last.number + 1 - count;
        kept_by_time += last.second_before + 1 - next;
        next = count;
    }
    EXPECT_GT(lost, 0) << "each was written before the next was kept";
    EXPECT_GT(kept_by_time, 0);
    expect_intact(folder / "db");
}

} // namespace

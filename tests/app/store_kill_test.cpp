#include <random>

#include "tests/app/store_life.h"
#include "tests/support/scoped_folder.h"

namespace {

using app::ResultStore;
using store_life::count_in;
using store_life::expect_intact;
using store_life::killed;
using store_life::Last;
using store_life::Life;
using test_support::ScopedFolder;

TEST(ResultStore, KeepsWhatWasWrittenThroughThirtyKills) {
    const ScopedFolder folder;
    const std::string program = folder.write("a.nc", "G0 X1\n");
    std::mt19937 random(7);
    int next = 0;
    for (int kill = 0; kill < 30; ++kill) {
        const Life life{true, kill % 3 != 0, static_cast<useconds_t>(random() % 30'000)};
        const Last last = killed(life, folder / "db", program, next);
        ASSERT_GE(last.number, next - 1) << "it ended by itself";
        auto store = ResultStore::open(folder / "db", "1");
        ASSERT_TRUE(store) << store.error().message;
        // The result in progress is stored completely or not at all.
        const int count = count_in(*store, program, last.number + 3);
        EXPECT_GE(count, last.number + 1);
        EXPECT_LE(count, last.number + 2);
        next = last.number + 1;
    }
    EXPECT_GE(next, 20);
    expect_intact(folder / "db");
}

TEST(ResultStore, LosesAtAKillOnlyTheLatestResults) {
    const ScopedFolder folder;
    const std::string program = folder.write("a.nc", "G0 X1\n");
    std::mt19937 random(8);
    int next = 0, lost = 0;
    for (int kill = 0; kill < 8; ++kill) {
        const Life life{false, true, static_cast<useconds_t>(random() % 500'000 + 200'000)};
        const Last last = killed(life, folder / "db", program, next);
        ASSERT_GE(last.number, next - 1) << "it ended by itself";
        auto store = ResultStore::open(folder / "db", "1");
        ASSERT_TRUE(store) << store.error().message;
        const int count = count_in(*store, program, last.number + 3);
        EXPECT_GE(count, next) << "a result of an earlier process is lost";
        EXPECT_LE(count, last.number + 2);
        lost += last.number + 1 - count;
        next = count;
    }
    EXPECT_GT(lost, 0) << "each was written before the next was kept";
    expect_intact(folder / "db");
}

} // namespace

#include <chrono>
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
using store_life::numbered;
using test_support::ScopedFolder;

TEST(ResultStore, KeepsWhatWasWrittenThroughThirtyKills) {
    const ScopedFolder folder;
    const std::string program = folder.write("a.nc", "G0 X1\n");
    std::mt19937 random(7);
    int next = 0;
    for (int kill = 0; kill < 30; ++kill) {
        const Life life{true, kill % 3 != 0, static_cast<useconds_t>(random() % 30'000)};
        const Last last = killed(life, folder / "db", program, next);
        ASSERT_GE(last.number, next - 1) << "it could not store a result";
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

TEST(ResultStore, LosesAtAKillNoResultOfAnEarlierProcess) {
    const ScopedFolder folder;
    const std::string program = folder.write("a.nc", "G0 X1\n");
    std::mt19937 random(8);
    int next = 0;
    for (int kill = 0; kill < 8; ++kill) {
        const Life life{false, true, static_cast<useconds_t>(random() % 500'000 + 200'000)};
        const Last last = killed(life, folder / "db", program, next);
        ASSERT_GE(last.number, next - 1) << "it could not store a result";
        auto store = ResultStore::open(folder / "db", "1");
        ASSERT_TRUE(store) << store.error().message;
        const int count = count_in(*store, program, last.number + 3);
        EXPECT_GE(count, next);
        EXPECT_LE(count, last.number + 2);
        next = count;
    }
    expect_intact(folder / "db");
}

/// Stores seven results, waits until the first three are written, and says so.
[[noreturn]] void keep_seven(const std::string& database, const std::string& program, int pipe) {
    auto store = ResultStore::open(database, "1", nullptr, std::chrono::hours(1));
    bool is_done = store.has_value();
    for (int i = 0; is_done && i < 7; ++i) {
        const store_life::Kept each = numbered(program, i);
        is_done = store->keep(each.job, each.run, each.result) && (i != 2 || store->flush());
    }
    if (!is_done || ::write(pipe, "", 1) != 1) ::_exit(1);
    while (true) ::pause();
}

TEST(ResultStore, LosesAtAKillWhatWasGatheredAndNotWritten) {
    const ScopedFolder folder;
    const std::string program = folder.write("a.nc", "G0 X1\n");
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    if (child == 0) keep_seven(folder / "db", program, ends[1]);
    ::close(ends[1]);
    char done = 0;
    EXPECT_EQ(::read(ends[0], &done, 1), 1) << "the process could not store its results";
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    ::close(ends[0]);
    auto store = ResultStore::open(folder / "db", "1");
    ASSERT_TRUE(store) << store.error().message;
    EXPECT_EQ(count_in(*store, program, 7), 3);
}

} // namespace

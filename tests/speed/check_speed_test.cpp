#include <atomic>
#include <thread>

#include <fmt/format.h>

#include "app/base/stopwatch.h"
#include "app/bench/bench_table.h"
#include "app/library/store/database.h"
#include "tests/app/checked.h"
#include "tests/app/many_files.h"
#include "tests/support/terminal.h"
#include "tests/support/usage.h"

namespace {

using app::Stopwatch;
using app_test::feeler;
using test_support::program;
using test_support::ScopedFolder;

const std::string fine = program({"X-20. Y50.", "Z-3.", "G1 X120. F500.", "G0 Z60."});

TEST(CheckSpeed, ChecksAHundredThousandFilesInTwentySecondsOfCpuTime) {
    const ScopedFolder folder;
    const std::string shop = folder / "shop";
    many_files::fill(shop);
    const test_support::Usage usage =
        test_support::usage_of({FEELER_BINARY, "check", shop, "--no-cache",
                                "--format",    "csv",   "-o", folder / "rows.csv",
                                "--format",    "html",  "-o", folder / "page.html",
                                "--format",    "sarif", "-o", folder / "report.sarif",
                                "--format",    "json",  "-o", folder / "whole.json"},
                               folder / "out.txt");
    EXPECT_EQ(usage.status, 0);
    EXPECT_LT(usage.cpu_seconds, 20.0);
}

TEST(CheckSpeed, SkipsTenThousandFilesWithinTenSeconds) {
    const ScopedFolder folder;
    for (int i = 0; i < 10'000; ++i)
        folder.write(fmt::format("{}.txt", i), "no program, and no block either\n");
    folder.write("one.nc", fine);
    const Stopwatch watch;
    EXPECT_EQ(feeler({"check", folder.path()}).status, 0);
    EXPECT_LT(watch.seconds(), 10.0);
}

TEST(CheckSpeed, WaitsTenSecondsInAllForALockedDatabase) {
    const ScopedFolder folder;
    for (const char* name : {"a.nc", "b.nc", "c.nc"}) folder.write(name, fine);
    feeler({"check", folder.path()});
    auto other =
        app::Database::open(folder / ".feeler/results.db", app::Database::Access::read_write);
    ASSERT_TRUE(other && other->run("BEGIN EXCLUSIVE"));
    const Stopwatch watch;
    EXPECT_EQ(feeler({"check", folder.path(), "--jobs", "1"}).status, 0);
    EXPECT_LT(watch.seconds(), 15.0);
}

TEST(CheckSpeed, WatchSeesAChangeWithinTwentySecondsWhileOthersWriteInTheFolder) {
    const ScopedFolder folder;
    folder.write("plate.nc", fine);
    test_support::Terminal terminal(
        {FEELER_BINARY, "check", "--watch", folder.path(), "--no-cache"}, folder.path());
    terminal.until("Ctrl-C ends it");
    folder.write("plate.nc", program({"G999"}));
    std::atomic<bool> is_over = false;
    std::thread busy([&] {
        for (int i = 0; !is_over; ++i) {
            folder.write(fmt::format("note {}", i), "");
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
    });
    const Stopwatch watch;
    EXPECT_NE(terminal.until("G999").find("plate.nc"), std::string::npos);
    EXPECT_LT(watch.seconds(), 20.0);
    is_over = true;
    busy.join();
}

/// Four times as many points; the limits leave room for a lot of noise.
TEST(BenchSpeed, TakesLongerForMorePoints) {
    app::BenchScene scene = app::paper_scene();
    scene.mesh_sizes = {1.0, 2.0};
    const std::vector<app::BenchAverages> means =
        app::averages_of(app::measure(scene, 0.0).value());
    EXPECT_GT(means[0].paper_seconds, 1.5 * means[1].paper_seconds);
    EXPECT_LT(means[0].paper_seconds, 50.0 * means[1].paper_seconds);
}

} // namespace

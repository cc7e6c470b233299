#include <chrono>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/base/sha256.h"
#include "app/library/store/result_store.h"
#include "tests/support/scoped_folder.h"

namespace {

using test_support::ScopedFolder;

app::InputFile content(const std::string& path) {
    return {core::FileQuestion::content, path, {}, app::sha256_of_file(path)};
}

TEST(ResultStore, FindsAThousandResultsInASecond) {
    const ScopedFolder folder;
    folder.write("vise.stl", std::string(1'000'000, 'v'));
    app::CheckJob job;
    auto filled = app::ResultStore::open(folder / "db", "1");
    ASSERT_TRUE(filled);
    for (int i = 0; i < 1000; ++i) {
        job.program = folder.write(fmt::format("{}.nc", i), fmt::format("G0 X{}\n", i));
        app::CheckRun run;
        run.sha256 = app::sha256_of_file(job.program);
        run.inputs = {content(job.program), content(folder / "vise.stl")};
        ASSERT_TRUE(filled->keep(job, run, app::result_of(run, "")));
    }
    ASSERT_TRUE(filled->flush());
    const auto begin = std::chrono::steady_clock::now();
    auto store = app::ResultStore::open(folder / "db", "1");
    ASSERT_TRUE(store);
    for (int i = 0; i < 1000; ++i) {
        job.program = folder / fmt::format("{}.nc", i);
        ASSERT_TRUE(store->find(job)->has_value()) << i;
    }
    ASSERT_TRUE(store->flush());
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    EXPECT_LT(taken.count(), 1.0);
    RecordProperty("milliseconds", static_cast<int>(1000.0 * taken.count()));
}

/// On a slow disk a transaction for each took ten times as long.
TEST(ResultStore, KeepsAThousandResultsInASecond) {
    const ScopedFolder folder;
    app::CheckJob job;
    job.program = folder.write("a.nc", "G0 X1\n");
    app::CheckRun run;
    run.sha256 = app::sha256_of_file(job.program);
    run.inputs = {content(job.program)};
    auto store = app::ResultStore::open(folder / "db", "1");
    ASSERT_TRUE(store);
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 1000; ++i) {
        job.start_line = fmt::format("{}", i); // so that each is a job of its own
        ASSERT_TRUE(store->keep(job, run, app::result_of(run, "")));
    }
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - begin;
    ASSERT_TRUE(store->flush());
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    EXPECT_LT(waited.count(), 0.5);
    EXPECT_LT(taken.count(), 1.0);
    RecordProperty("milliseconds_waited", static_cast<int>(1000.0 * waited.count()));
    RecordProperty("milliseconds", static_cast<int>(1000.0 * taken.count()));
}

} // namespace

#include <chrono>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/batch/result_store.h"
#include "app/session/digest.h"
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
    const auto begin = std::chrono::steady_clock::now();
    auto store = app::ResultStore::open(folder / "db", "1");
    ASSERT_TRUE(store);
    for (int i = 0; i < 1000; ++i) {
        job.program = folder / fmt::format("{}.nc", i);
        ASSERT_TRUE(store->find(job)->has_value()) << i;
    }
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    EXPECT_LT(taken.count(), 1.0);
    RecordProperty("milliseconds", static_cast<int>(1000.0 * taken.count()));
}

} // namespace

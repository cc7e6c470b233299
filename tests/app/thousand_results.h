#pragma once

#include <chrono>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/base/sha256.h"
#include "app/check/check_run.h"
#include "app/library/store/result_store.h"
#include "core/base/file_reads.h"
#include "tests/support/scoped_folder.h"

namespace store_life {

/// A thousand programs, the large mesh that all of them are checked with, and a database for the
/// results.
class ThousandResults {
public:
    static constexpr size_t count = 1000, mesh_bytes = 1'000'000;

    ThousandResults() {
        for (size_t i = 0; i < count; ++i)
            folder.write(fmt::format("{}.nc", i), fmt::format("G0 X{}\n", i));
    }

    /// Stores all results, like a batch that checks everything. `gathering`: see ResultStore::open.
    void keep_all(std::chrono::milliseconds gathering = std::chrono::milliseconds(150)) const {
        auto store = app::ResultStore::open(database, "1", nullptr, gathering);
        ASSERT_TRUE(store);
        const std::string digest = app::sha256_of_file(mesh);
        for (size_t i = 0; i < count; ++i) {
            const app::CheckJob job = job_of(i);
            app::CheckRun run;
            run.sha256 = app::sha256_of_file(job.program);
            run.inputs = {{core::FileAccessKind::content, job.program, {}, run.sha256},
                          {core::FileAccessKind::content, mesh, {}, digest}};
            ASSERT_TRUE(store->keep(job, run, app::result_of(run, "")));
        }
        ASSERT_TRUE(store->flush());
    }

    /// Finds all results, like a batch in which no file has changed.
    void find_all() const {
        auto store = app::ResultStore::open(database, "1");
        ASSERT_TRUE(store);
        for (size_t i = 0; i < count; ++i) ASSERT_TRUE(store->find(job_of(i))->has_value()) << i;
        ASSERT_TRUE(store->flush());
    }

    const test_support::ScopedFolder folder;
    const std::string database = folder / "db";
    const std::string mesh = folder.write("vise.stl", std::string(mesh_bytes, 'v'));

private:
    app::CheckJob job_of(size_t i) const {
        app::CheckJob job;
        job.program = folder / fmt::format("{}.nc", i);
        return job;
    }
};

} // namespace store_life

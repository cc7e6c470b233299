#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/base/sha256.h"
#include "app/check/check_run.h"
#include "app/check/input_file.h"
#include "app/library/store/database.h"
#include "app/library/store/result_store.h"
#include "core/base/file_reads.h"
#include "tests/support/scoped_folder.h"

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

using app::CheckJob;
using app::CheckRun;
using app::ProgramResult;
using app::ResultStore;
using core::FileAccessKind;
using test_support::ScopedFolder;

app::InputFile content(const std::string& path) {
    return {FileAccessKind::content, path, {}, app::sha256_of_file(path)};
}

ResultStore opened(const std::string& path) {
    auto store = ResultStore::open(path, "1");
    if (!store) throw std::runtime_error(store.error().message);
    return *std::move(store);
}

/// Job `number` of a folder, each with its own program.
struct Numbered {
    Numbered(const ScopedFolder& folder, int number) {
        job.program = folder.write(fmt::format("{}.nc", number), fmt::format("G0 X{}\n", number));
        run.sha256 = app::sha256_of_file(job.program);
        run.inputs = {content(job.program), content(folder / "vise.stl")};
        result.program = job.program;
        result.cycle_time = number;
    }

    CheckJob job;
    CheckRun run;
    ProgramResult result;
};

class OneResult : public testing::Test {
protected:
    /// The result as another process finds it.
    std::optional<ProgramResult> found() const { return *opened(path).find(each.job); }

    const ScopedFolder folder;
    const std::string mesh = folder.write("vise.stl", "solid");
    const std::string path = folder / "db";
    const Numbered each{folder, 1};
};

TEST_F(OneResult, IsThereAtOnceForWhoeverWaitsForIt) {
    ResultStore store = opened(path);
    ASSERT_TRUE(store.keep(each.job, each.run, each.result));
    ASSERT_TRUE(store.flush());
    EXPECT_EQ(*store.find(each.job), each.result);
}

TEST_F(OneResult, IsWrittenWithoutAFlush) {
    ResultStore store = opened(path);
    ASSERT_TRUE(store.keep(each.job, each.run, each.result));
    const auto end = std::chrono::steady_clock::now() + 60s; // clock: gives up after 1 min
    while (found() != each.result && std::chrono::steady_clock::now() < end) // clock: as above
        std::this_thread::sleep_for(10ms);                                   // clock: polls
    EXPECT_EQ(found(), each.result);
}

TEST_F(OneResult, IsRefusedWhileSomebodyHasTheDatabase) {
    std::atomic<bool> is_stopped = false;
    std::atomic<int> attempts = 0;
    auto store = ResultStore::open(path, "1", std::make_shared<app::RetryBudget>([&] {
                                       ++attempts;
                                       return is_stopped.load();
                                   }));
    ASSERT_TRUE(store);
    auto other = app::Database::open(path, app::Database::Access::read_write);
    ASSERT_TRUE(other && other->run("BEGIN EXCLUSIVE"));
    ASSERT_TRUE(store->keep(each.job, each.run, each.result)) << "the write is deferred";
    EXPECT_EQ(store->find(each.job).error().message, "database is locked");
    EXPECT_EQ(store->flush().error().message, "database is locked");
    EXPECT_FALSE(store->keep(each.job, each.run, each.result));
    EXPECT_GT(attempts, 100) << "it gives up before the others are done";
    ASSERT_TRUE(other->run("COMMIT"));
    EXPECT_EQ(*store->find(each.job), std::nullopt);
    store->try_again();
    ASSERT_TRUE(store->keep(each.job, each.run, each.result));
    ASSERT_TRUE(store->flush());
    EXPECT_EQ(*store->find(each.job), each.result);
    is_stopped = true;
    ASSERT_TRUE(other->run("BEGIN EXCLUSIVE"));
    const int before = attempts.exchange(0);
    EXPECT_FALSE(store->find(each.job));
    EXPECT_LT(2 * attempts, before) << "a stopping run waits less";
}

TEST(ResultStore, OfAnOlderFormatIsTakenOver) {
    const ScopedFolder folder;
    folder.write("vise.stl", "solid");
    const Numbered each(folder, 1), other(folder, 2);
    { ASSERT_TRUE(opened(folder / "db").keep(each.job, each.run, each.result)); }
    {
        auto older = app::Database::open(folder / "db", app::Database::Access::read_write);
        ASSERT_TRUE(older && older->run("DROP TABLE seen; PRAGMA user_version = 1"));
    }
    const ResultStore own = opened(folder / "own");
    const auto refused = ResultStore::open_sibling(folder / "db", own);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message, "was written by an older version of Feeler");
    EXPECT_EQ(*opened(folder / "db").find(each.job), each.result);
    { ASSERT_TRUE(opened(folder / "db").keep(other.job, other.run, other.result)); }
    EXPECT_EQ(*opened(folder / "db").find(other.job), other.result);
    EXPECT_EQ(opened(folder / "db").history(each.job.program)->size(), 1u);
}

TEST(ResultStore, InMemoryLeavesNoFile) {
    const ScopedFolder folder;
    folder.write("vise.stl", "solid");
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    const Numbered each(folder, 1);
    {
        ResultStore store = opened(app::Database::in_memory);
        ASSERT_TRUE(store.keep(each.job, each.run, each.result) && store.flush());
        EXPECT_EQ(*store.find(each.job), each.result);
    }
    fs::current_path(before);
    size_t files = 0;
    for (const auto& entry : fs::directory_iterator(folder.path())) files += entry.exists();
    EXPECT_EQ(files, 2u) << "a program and a mesh";
}

TEST(ResultStore, IsFilledByManyAtOnceAndLosesNothing) {
    const ScopedFolder folder;
    folder.write("vise.stl", "solid");
    std::vector<Numbered> jobs;
    for (int i = 0; i < 60; ++i) jobs.emplace_back(folder, i);
    std::atomic<int> refused = 0;
    std::vector<std::thread> threads;
    ResultStore shared = opened(folder / "db");
    for (int thread = 0; thread < 4; ++thread) {
        threads.emplace_back([&, thread] {
            ResultStore own = opened(folder / "db"); // as in another process
            ResultStore& store = thread < 2 ? shared : own;
            for (int i = thread % 2; i < 60; i += 2)
                if (!store.keep(jobs[i].job, jobs[i].run, jobs[i].result)) ++refused;
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(refused, 0);
    EXPECT_TRUE(shared.flush());
    ResultStore store = opened(folder / "db");
    for (const Numbered& each : jobs) EXPECT_EQ(*store.find(each.job), each.result);
    EXPECT_EQ(store.history(jobs[0].job.program)->size(), 1u);
}

/// Runs an action in a process with a limited file size, to simulate a full disk.
template <typename Action>
void with_full_disk(rlim_t bytes, const Action& action) {
    const pid_t child = ::fork();
    if (child == 0) {
        std::signal(SIGXFSZ, SIG_IGN); // makes writing fail, as on a full disk
        const rlimit limit{bytes, bytes};
        ::_exit(::setrlimit(RLIMIT_FSIZE, &limit) == 0 && action() ? 0 : 1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(ResultStore, OnAFullDiskRefusesWhatItHasNoRoomForAndLosesNothing) {
    const ScopedFolder folder;
    folder.write("vise.stl", "solid");
    std::vector<Numbered> jobs;
    for (int i = 0; i < 40; ++i) {
        jobs.emplace_back(folder, i);
        jobs.back().result.assumptions = {std::string(5000, 'a')};
    }
    constexpr int before = 5;
    {
        ResultStore store = opened(folder / "db");
        for (int i = 0; i < before; ++i)
            ASSERT_TRUE(store.keep(jobs[i].job, jobs[i].run, jobs[i].result));
    }
    with_full_disk(fs::file_size(folder / "db") + 40'000, [&] {
        ResultStore store = opened(folder / "db");
        int kept = before;
        while (kept < 40 && store.keep(jobs[kept].job, jobs[kept].run, jobs[kept].result)
               && store.flush())
            ++kept;
        const auto refused = store.keep(jobs[39].job, jobs[39].run, jobs[39].result);
        // The running process still finds what it has stored.
        return kept > before && kept < 40 && !refused && !refused.error().message.empty()
               && *store.find(jobs[kept - 1].job) == jobs[kept - 1].result;
    });
    ResultStore store = opened(folder / "db");
    for (int i = 0; i < before; ++i) EXPECT_EQ(*store.find(jobs[i].job), jobs[i].result);
    EXPECT_EQ(*store.find(jobs[39].job), std::nullopt);
    EXPECT_TRUE(store.keep(jobs[39].job, jobs[39].run, jobs[39].result));
    EXPECT_TRUE(store.flush());
    EXPECT_EQ(*store.find(jobs[39].job), jobs[39].result);
}

/// Another process, with read-only access to the file of a store.
TEST(ResultStore, ThatMayNotBeWrittenStillFindsResults) {
    const ScopedFolder folder;
    folder.write("vise.stl", "solid");
    const Numbered each(folder, 1), other(folder, 2);
    { ASSERT_TRUE(opened(folder / "db").keep(each.job, each.run, each.result)); }
    const pid_t child = ::fork();
    if (child == 0) {
        fs::permissions(folder / "db", fs::perms(0444));
        fs::permissions(folder.path(), fs::perms(0555));
        if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(2);
        auto store = ResultStore::open(folder / "db", "1");
        const bool finds = store && *store->find(each.job) == each.result;
        const bool sees = store && store->flush(); // it need not store that it was used
        const bool refuses =
            store && store->keep(other.job, other.run, other.result) && !store->flush();
        ::_exit(finds && sees && refuses ? 0 : 1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    fs::permissions(folder.path(), fs::perms(0755));
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << WEXITSTATUS(status);
}

} // namespace

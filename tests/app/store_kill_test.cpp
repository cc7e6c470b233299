#include <csignal>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/batch/database.h"
#include "app/batch/result_store.h"
#include "app/session/digest.h"
#include "tests/support/scoped_folder.h"

namespace {

using app::ResultStore;
using test_support::ScopedFolder;

constexpr int program_count = 2000;

struct Kept {
    app::CheckJob job;
    app::CheckRun run;
    app::ProgramResult result;
};

Kept numbered(const std::string& program, int number) {
    Kept kept;
    kept.job.program = program;
    kept.job.start_line = fmt::format("{}", number); // so that each is a job of its own
    kept.run.sha256 = app::sha256_of_file(program);
    kept.run.inputs = {{core::FileQuestion::content, program, {}, kept.run.sha256}};
    kept.result.program = program;
    kept.result.blocks = static_cast<size_t>(number);
    kept.result.assumptions.assign(20, std::string(200, static_cast<char>('a' + number % 26)));
    return kept;
}

/// Keeps one result after the other and writes the number of each to a pipe once it is kept, until
/// somebody ends it.
[[noreturn]] void keep_on(const std::string& database, const std::string& program, int first,
                          int pipe) {
    auto store = ResultStore::open(database, "1");
    for (int i = first; store && i < program_count; ++i) {
        const Kept each = numbered(program, i);
        if (!store->keep(each.job, each.run, each.result)) break;
        if (::write(pipe, &i, sizeof i) != sizeof i) break;
    }
    ::_exit(0);
}

/// When a process is killed: so many microseconds after its start, or after it has kept a result.
struct Moment {
    bool after_first = false;
    useconds_t wait = 0;
};

/// Starts such a process, kills it, and gives the last number that it wrote.
int killed_at(const Moment& moment, const std::string& database, const std::string& program,
              int first) {
    int ends[2];
    if (::pipe(ends) != 0) return -1;
    const pid_t child = ::fork();
    if (child == 0) keep_on(database, program, first, ends[1]);
    ::close(ends[1]);
    int last = first - 1, number = 0;
    const auto reads_number = [&] {
        return ::read(ends[0], &number, sizeof number) == sizeof number;
    };
    if (moment.after_first && reads_number()) last = number;
    ::usleep(moment.wait);
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    while (reads_number()) last = number;
    ::close(ends[0]);
    return WIFSIGNALED(status) ? last : -1;
}

TEST(ResultStore, KeepsWhatWasKeptThroughThirtyKills) {
    const ScopedFolder folder;
    const std::string program = folder.write("a.nc", "G0 X1\n");
    std::mt19937 random(7);
    int next = 0;
    for (int kill = 0; kill < 30; ++kill) {
        const Moment moment{kill % 3 != 0, static_cast<useconds_t>(random() % 30'000)};
        const int last = killed_at(moment, folder / "db", program, next);
        ASSERT_GE(last, next - 1) << "it ended by itself";
        auto store = ResultStore::open(folder / "db", "1");
        ASSERT_TRUE(store) << store.error().message;
        for (int i = 0; i <= last; ++i) {
            const Kept each = numbered(program, i);
            const auto found = store->find(each.job);
            ASSERT_TRUE(found) << found.error().message;
            ASSERT_EQ(*found, each.result) << i;
        }
        // The one in progress is there wholly or not at all.
        const Kept open = numbered(program, last + 1);
        const auto found = store->find(open.job);
        ASSERT_TRUE(found) << found.error().message;
        if (*found) {
            EXPECT_EQ(**found, open.result);
        }
        next = last + 1;
    }
    EXPECT_GE(next, 20);
    auto database = app::Database::open(folder / "db", app::Database::Access::read_only);
    ASSERT_TRUE(database);
    auto check = database->prepare("PRAGMA integrity_check");
    ASSERT_TRUE(check);
    ASSERT_TRUE(*check->step());
    EXPECT_EQ(check->text(0), "ok");
}

} // namespace

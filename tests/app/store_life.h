#pragma once

#include <algorithm>
#include <csignal>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/base/sha256.h"
#include "app/check/check_run.h"
#include "app/library/store/database.h"
#include "app/library/store/result_store.h"
#include "core/base/file_reads.h"

/// Processes that store results in a database until they are killed.
namespace store_life {

inline constexpr int most_results = 2000; // of one process

struct Kept {
    app::CheckJob job;
    app::CheckRun run;
    app::ProgramResult result;
};

inline Kept numbered(const std::string& program, int number) {
    Kept kept;
    kept.job.program = program;
    kept.job.start_line = fmt::format("{}", number); // so that each is a separate job
    kept.run.sha256 = app::sha256_of_file(program);
    kept.run.inputs = {{core::FileAccessKind::content, program, {}, kept.run.sha256}};
    kept.result.program = program;
    kept.result.blocks = static_cast<size_t>(number);
    kept.result.assumptions.assign(20, std::string(200, static_cast<char>('a' + number % 26)));
    return kept;
}

/// How a process stores results: whether it waits until each is written, and when it is killed:
/// `length` microseconds after its start, or after it has stored a result.
struct Life {
    bool waits = false, is_from_first = false;
    useconds_t length = 0;
};

/// Stores one result after another and writes its number to a pipe once it is stored, until the
/// process is killed. Ends only if it cannot store a result.
[[noreturn]] inline void keep_on(const Life& life, const std::string& database,
                                 const std::string& program, int first, int pipe) {
    auto store = app::ResultStore::open(database, "1");
    if (!store) ::_exit(1);
    for (int i = first; i < first + most_results; ++i) {
        const Kept each = numbered(program, i);
        if (!store->keep(each.job, each.run, each.result)) ::_exit(1);
        if (life.waits && !store->flush()) ::_exit(1);
        if (!life.waits) ::usleep(5'000); // clock: any pause
        if (::write(pipe, &i, sizeof i) != sizeof i) ::_exit(1);
    }
    while (true) ::pause();
}

/// The last number that a process wrote, and the last one a second before its end.
struct Last {
    int number = -1, second_before = -1;
};

/// Starts such a process and kills it.
inline Last killed(const Life& life, const std::string& database, const std::string& program,
                   int first) {
    int ends[2];
    if (::pipe(ends) != 0) return {};
    const pid_t child = ::fork();
    if (child == 0) keep_on(life, database, program, first, ends[1]);
    ::close(ends[1]);
    Last last{first - 1, first - 1};
    int number = 0;
    const auto reads_number = [&] {
        return ::read(ends[0], &number, sizeof number) == sizeof number;
    };
    if (life.is_from_first && reads_number()) last.number = number;
    constexpr useconds_t second = 1'000'000;
    if (life.length > second) {
        ::usleep(life.length - second); // clock: for tests/speed
        for (int waiting = 0; ::ioctl(ends[0], FIONREAD, &waiting) == 0 && waiting > 0;)
            if (reads_number()) last.number = number;
        last.second_before = last.number;
    }
    ::usleep(std::min(life.length, second)); // clock: kills at any moment
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    while (reads_number()) last.number = number;
    ::close(ends[0]);
    return WIFSIGNALED(status) ? last : Last{};
}

/// The number of stored results. They must be the first ones without a gap, and equal to what was
/// stored.
inline int count_in(app::ResultStore& store, const std::string& program, int most) {
    int count = 0;
    for (int i = 0; i < most; ++i) {
        const Kept each = numbered(program, i);
        const auto found = store.find(each.job);
        if (!found) ADD_FAILURE() << found.error().message;
        if (!found || !*found) continue;
        EXPECT_EQ(**found, each.result) << i;
        EXPECT_EQ(i, count) << "one before it is missing";
        count = i + 1;
    }
    return count;
}

inline void expect_intact(const std::string& path) {
    auto database = app::Database::open(path, app::Database::Access::read_only);
    ASSERT_TRUE(database);
    auto check = database->prepare("PRAGMA integrity_check");
    ASSERT_TRUE(check);
    ASSERT_TRUE(*check->step());
    EXPECT_EQ(check->text(0), "ok");
}

} // namespace store_life

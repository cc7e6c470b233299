#include <atomic>
#include <barrier>
#include <thread>

#include <gmock/gmock.h>

#include "app/check/check_run.h"
#include "app/library/run/batch_job.h"
#include "app/library/run/batch_run.h"
#include "app/report/json/json_report.h"
#include "app/report/text/batch_text.h"
#include "tests/support/program_writer.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace app {
namespace {

using test_support::program;
using test_support::ScopedFolder;
using test_support::SetupWriter;
using testing::HasSubstr;

/// A folder of programs that are clear, near a clamp, wrong, and endless, with one set-up.
class BatchRun : public testing::Test {
protected:
    void SetUp() override {
        asked.setup = folder.write(
            "setup.toml",
            SetupWriter().fixture("clamp", "box = [[40, 104, 0], [60, 130, 42]]").text());
        for (int i = 0; i < 4; ++i) {
            const std::string depth = "Z-" + std::to_string(i + 1) + ".";
            folder.write("clear" + std::to_string(i) + ".nc",
                         program({"X-20. Y50.", depth, "G1 X120. F500.", "G0 Z60."}));
            folder.write("near" + std::to_string(i) + ".nc",
                         program({"X-20. Y97.5", depth, "G1 X120. F500.", "G0 Z60."}));
        }
        folder.write("wrong.nc", program({"G0 X1.", "G999"}));
        folder.write("endless.nc", program({"F500.", "#1=0", "WHILE[#1LT1000000]DO1", "G1 X#1",
                                            "#1=#1+0.001", "END1"}));
        asked.settings.max_blocks = 500;
    }

    BatchPlan plan() const { return *plan_batch({folder.path().string()}, asked); }

    static BatchResult without_seconds(BatchResult batch) {
        for (ProgramResult& program : batch.programs) program.seconds = 0.0;
        return batch;
    }

    /// The result of the program with this name.
    static ProgramResult of(const BatchResult& batch, const std::string& name) {
        for (const ProgramResult& program : batch.programs)
            if (program.program.ends_with("/" + name)) return program;
        ADD_FAILURE() << "no result of " << name;
        return {};
    }

    ScopedFolder folder;
    CheckJob asked;
};

TEST_F(BatchRun, GivesTheSameForAnyNumberOfJobs) {
    const BatchResult one = without_seconds(run_batch(plan(), {.jobs = 1}, {}));
    const BatchResult four = without_seconds(run_batch(plan(), {.jobs = 4}, {}));
    const BatchResult tight = without_seconds(run_batch(plan(), {.jobs = 4, .memory = 1.0}, {}));
    EXPECT_EQ(one.programs.size(), 10U);
    EXPECT_EQ(batch_json_report(one), batch_json_report(four));
    EXPECT_EQ(batch_json_report(one), batch_json_report(tight));
    EXPECT_EQ(batch_text(one, {.verbose = true}), batch_text(four, {.verbose = true}));
}

TEST_F(BatchRun, ContinuesAfterABadProgram) {
    const BatchResult batch = run_batch(plan(), {}, {});
    EXPECT_EQ(status_of(of(batch, "clear0.nc")), 0);
    EXPECT_EQ(status_of(of(batch, "near0.nc")), 1);
    EXPECT_EQ(status_of(of(batch, "wrong.nc")), 2);
    EXPECT_EQ(of(batch, "wrong.nc").error->line, 7U);
    EXPECT_EQ(status_of(of(batch, "near3.nc")), 1);
    EXPECT_EQ(status_of(batch), 2);
}

TEST_F(BatchRun, SaysTheColumnInCharacters) {
    folder.write("umlaut.nc", "\xef\xbb\xbfG21\n(\xc3\xa9\xc3\xa9\xe6\x97\xa5) G999\n");
    const BatchResult batch = run_batch(*plan_batch({folder / "umlaut.nc"}, asked), {}, {});
    EXPECT_EQ(batch.programs[0].error->line, 2U);
    EXPECT_EQ(batch.programs[0].error->column, 7U);
}

TEST_F(BatchRun, SaysWhichProgramRanIntoTheLimitOfBlocks) {
    const ProgramResult endless = of(run_batch(plan(), {}, {}), "endless.nc");
    ASSERT_TRUE(endless.error);
    EXPECT_THAT(endless.error->message, HasSubstr("500"));
    EXPECT_EQ(endless.verdict, core::Verdict::undecided);
}

TEST_F(BatchRun, ReportsEachProgramOnce) {
    std::vector<std::string> ended, kept;
    BatchProgress last;
    BatchHooks hooks;
    hooks.ended = [&](const ProgramResult& result) { ended.push_back(result.program); };
    hooks.keep = [&](const CheckJob& job, const CheckRun& run, const ProgramResult& result) {
        EXPECT_EQ(run.blocks.size(), result.blocks);
        kept.push_back(job.program);
    };
    hooks.waiting = [&](const BatchProgress& progress) {
        EXPECT_LE(progress.fraction, 1.0 + 1e-9);
        last = progress;
    };
    const BatchPlan all = plan();
    run_batch(all, {.jobs = 3}, hooks);
    std::vector<std::string> names;
    for (const CheckJob& job : all.jobs) names.push_back(job.program);
    EXPECT_THAT(ended, testing::UnorderedElementsAreArray(names));
    EXPECT_THAT(kept, testing::UnorderedElementsAreArray(names));
    EXPECT_EQ(last.done, 10U);
    EXPECT_EQ(last.with_errors, 6U);
    EXPECT_NEAR(last.fraction, 1.0, 1e-9);
}

TEST_F(BatchRun, DoesNotRunWhatIsKnown) {
    std::atomic<int> run = 0;
    BatchHooks hooks;
    hooks.known = [](const CheckJob& job) {
        return job.program.ends_with("near0.nc")
                   ? std::nullopt
                   : std::optional<ProgramResult>({.program = job.program, .blocks = 77});
    };
    hooks.keep = [&](const auto&, const auto&, const auto&) { ++run; };
    const BatchResult batch = run_batch(plan(), {.jobs = 2}, hooks);
    EXPECT_EQ(run, 1);
    EXPECT_EQ(of(batch, "wrong.nc").blocks, 77U);
    EXPECT_EQ(status_of(of(batch, "near0.nc")), 1);
}

TEST_F(BatchRun, StopsWhileAProgramIsLookedOver) {
    asked.setup.clear(); // so that the whole program is run once to infer its stock
    asked.settings.max_blocks.reset();
    const BatchPlan endless = *plan_batch({folder / "endless.nc"}, asked);
    std::atomic<int> questions = 0;
    BatchHooks hooks;
    hooks.is_stopped = [&] { return ++questions >= 20; };
    const BatchResult batch = run_batch(endless, {}, hooks);
    EXPECT_GE(questions, 20) << "the program was still looked over";
    EXPECT_LT(questions, 40) << "it continues after it was stopped";
    EXPECT_EQ(batch.unchecked.size(), 1U);
    EXPECT_TRUE(batch.programs.empty());
}

TEST_F(BatchRun, KeepsWhatHasEndedWhenItIsStopped) {
    for (const unsigned jobs : {1U, 4U}) {
        std::atomic<bool> stopped = false;
        BatchHooks hooks;
        hooks.is_stopped = [&] { return stopped.load(); };
        size_t kept = 0;
        hooks.keep = [&](const auto&, const auto&, const auto&) {
            ++kept;
            stopped = true;
        };
        const BatchResult batch = run_batch(plan(), {.jobs = jobs}, hooks);
        EXPECT_GE(batch.programs.size(), 1U);
        EXPECT_EQ(batch.programs.size(), kept) << "the result of a check that was cut short";
        EXPECT_EQ(batch.programs.size() + batch.unchecked.size(), 10U);
        EXPECT_GE(batch.unchecked.size(), 10U - jobs);
        EXPECT_EQ(status_of(batch), 2);
        EXPECT_THAT(batch_summary(batch, 1.0, {}), HasSubstr("not checked: "));
    }
}

TEST_F(BatchRun, MakesWordsThatNameNothingAFailure) {
    const BatchPlan empty = *plan_batch({folder / "*.tap", folder / "none.nc"}, asked);
    const BatchResult batch = run_batch(empty, {}, {});
    ASSERT_EQ(batch.programs.size(), 2U);
    EXPECT_EQ(status_of(batch), 2);
    for (const ProgramResult& program : batch.programs) EXPECT_TRUE(program.error);
}

TEST(MemoryBudget, HoldsWhatIsTakenAtTheSameTimeWithinIt) {
    MemoryBudget budget(10.0);
    std::atomic<int> taken = 0, most = 0;
    std::barrier all_have_some(8);
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i)
        threads.emplace_back([&, i] {
            for (int round = 0; round < 50; ++round) {
                const int bytes = round == 0 ? 1 : 1 + (i * 7 + round) % 6;
                ASSERT_TRUE(budget.take(bytes, [] { return false; }));
                const int now = taken += bytes;
                for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
                }
                if (round == 0) all_have_some.arrive_and_wait();
                std::this_thread::yield();
                taken -= bytes;
                budget.give_back(bytes);
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_LE(most, 10);
    EXPECT_GE(most, 8) << "all threads held one byte at the same time";
}

TEST(MemoryBudget, GivesItAllToOneThatIsLarger) {
    MemoryBudget budget(10.0);
    ASSERT_TRUE(budget.take(1.0, [] { return false; }));
    std::atomic<bool> large = false, small = false;
    std::atomic<int> large_asked = 0, small_asked = 0; // whether to give up: shows that it waits
    std::thread first([&] {
        EXPECT_TRUE(budget.take(100.0, [&] { return ++large_asked < 0; }));
        large = true;
    });
    while (large_asked == 0) std::this_thread::yield();
    std::thread second([&] {
        EXPECT_TRUE(budget.take(1.0, [&] { return ++small_asked < 0; }));
        small = true;
    });
    const auto wait_for_two_more_looks = [&] {
        for (const int seen = small_asked; small_asked < seen + 2 && !small;)
            std::this_thread::yield();
    };
    wait_for_two_more_looks();
    EXPECT_FALSE(large);
    EXPECT_FALSE(small) << "the small one overtook the large one";
    budget.give_back(1.0);
    first.join();
    wait_for_two_more_looks();
    EXPECT_FALSE(small) << "the large one must run alone";
    budget.give_back(100.0);
    second.join();
}

TEST(MemoryBudget, LetsNoThreadWaitAfterAStop) {
    MemoryBudget budget(10.0);
    ASSERT_TRUE(budget.take(8.0, [] { return false; }));
    EXPECT_FALSE(budget.take(8.0, [] { return true; }));
    EXPECT_TRUE(budget.take(2.0, [] { return false; })) << "a job that gave up took no memory";
}

} // namespace
} // namespace app

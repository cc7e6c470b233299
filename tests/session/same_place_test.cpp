#include <random>

#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/run_state.h"
#include "app/debug/debug_session.h"
#include "tests/session/walked_program.h"

namespace session_test {
namespace {

struct WalkedSession {
    ProgramFiles files{"walked.ngc", walked_program(), walked_setup()};
    std::vector<uint64_t> digests = digests_of(files.job());
    std::unique_ptr<app::DebugSession> session;

    explicit WalkedSession(size_t memory_budget) {
        auto opened = app::DebugSession::open(files.job(), memory_budget);
        EXPECT_TRUE(opened) << opened.error().message;
        if (opened) session = *std::move(opened);
    }
};

/// One random step through the session.
void walk_somewhere(app::DebugSession& session, std::mt19937& random, size_t last) {
    const auto below = [&](size_t count) { return random() % count; };
    switch (below(12)) {
    case 0:
        (void)session.go_to(below(last + 1));
        break;
    case 1:
        session.step(1 + below(40));
        break;
    case 2:
        session.step_back(1 + below(40));
        break;
    case 3:
        session.next();
        break;
    case 4:
        session.next_back();
        break;
    case 5:
        session.finish();
        break;
    case 6:
        session.next_finding();
        break;
    case 7:
        session.previous_tool();
        break;
    case 8:
        session.step_back();
        break;
    default:
        session.step();
        break;
    }
}

void expect_same_places(size_t memory_budget, size_t steps, unsigned seed) {
    WalkedSession walked(memory_budget);
    app::DebugSession& session = *walked.session;
    ASSERT_GT(walked.digests.size(), 300U);
    std::mt19937 random(seed);
    std::set<size_t> seen;
    for (size_t i = 0; i < steps; ++i) {
        walk_somewhere(session, random, walked.digests.size() - 1);
        ASSERT_LT(session.at(), walked.digests.size());
        ASSERT_EQ(app::digest_of(session.state()), walked.digests[session.at()])
            << "walk " << i << " at " << session.at();
        seen.insert(session.at());
    }
    EXPECT_GT(seen.size(), walked.digests.size() / 3);
}

TEST(SameBlock, HasTheSameStateByAnyRoute) {
    expect_same_places(app::DebugSession::default_memory_budget, 10'000, 1);
}

TEST(SameBlock, HasTheSameStateWithFewKeyframes) { expect_same_places(1 << 20, 1'000, 2); }

TEST(SameBlock, DiffersFromEveryOther) {
    const WalkedSession walked(1 << 20);
    const std::set<uint64_t> different(walked.digests.begin(), walked.digests.end());
    EXPECT_EQ(different.size(), walked.digests.size());
}

TEST(RecordedRun, EqualsACheckWhateverWasVisited) {
    const ProgramFiles files("walked.ngc", walked_program(), walked_setup());
    const auto whole = app::run_check(files.job());
    ASSERT_TRUE(whole);
    auto session = app::DebugSession::open(files.job(), 1 << 22);
    ASSERT_TRUE(session);
    std::mt19937 random(3);
    while ((*session)->record_for(0.0))
        if (random() % 8 == 0) (void)(*session)->go_to(random() % ((*session)->at() + 40));
    EXPECT_EQ(report_of((*session)->record()), report_of(*whole));
}

TEST(Keyframes, StayWithinTheirMemory) {
    constexpr size_t budget = 3 << 20;
    WalkedSession walked(budget);
    app::DebugSession& session = *walked.session;
    while (session.record_for(1.0)) {
    }
    for (size_t position = 0; position < walked.digests.size(); position += 7) {
        ASSERT_TRUE(session.go_to(position));
        EXPECT_LE(session.keyframe_memory(), budget);
    }
    EXPECT_GE(session.keyframe_count(), 2U);
}

} // namespace
} // namespace session_test

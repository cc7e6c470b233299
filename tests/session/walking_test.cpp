#include <gtest/gtest.h>

#include "app/check/check_run.h"
#include "app/debug/debug_session.h"
#include "tests/session/walked_program.h"

namespace session_test {
namespace {

class Walking : public testing::Test {
protected:
    void SetUp() override {
        auto opened = app::DebugSession::open(files.job());
        ASSERT_TRUE(opened) << opened.error().message;
        session = *std::move(opened);
    }
    app::CheckedBlock next() const { return session->record().blocks[session->at()]; }

    ProgramFiles files{"walked.ngc", walked_program(), walked_setup()};
    std::unique_ptr<app::DebugSession> session;
};

TEST_F(Walking, StopsBeforeALineEveryTimeItIsRun) {
    app::Breakpoint breakpoint;
    breakpoint.line = 13; // in <corner>
    const int id = session->add(breakpoint);
    size_t stops = 0;
    while (true) {
        const app::Stop stop = session->go_on();
        if (stop.reason == app::StopReason::end) break;
        ASSERT_EQ(stop.reason, app::StopReason::breakpoint);
        EXPECT_EQ(stop.id, id);
        EXPECT_EQ(next().line, 13U);
        EXPECT_EQ(next().calls.size(), 2U);
        ++stops;
    }
    EXPECT_EQ(stops, 18U);
    EXPECT_EQ(session->breakpoints()[0].hits, 18U);
    while (session->reverse_resume().reason == app::StopReason::breakpoint) --stops;
    EXPECT_EQ(stops, 0U);
    EXPECT_EQ(session->at(), 0U);
}

TEST_F(Walking, StepsOverAndOutOfSubprograms) {
    app::Breakpoint breakpoint;
    breakpoint.line = 6; // where <square> calls <corner>
    breakpoint.temporary = true;
    session->add(breakpoint);
    ASSERT_EQ(session->go_on().reason, app::StopReason::breakpoint);
    EXPECT_TRUE(session->breakpoints().empty());
    EXPECT_EQ(next().calls.size(), 1U);
    session->step();
    EXPECT_EQ(next().calls.size(), 2U);
    session->step_back();
    EXPECT_EQ(next().line, 6U);
    session->next();
    EXPECT_EQ(next().line, 7U);
    session->next_back();
    EXPECT_EQ(next().line, 6U);
    session->finish();
    EXPECT_TRUE(next().calls.empty());
}

TEST_F(Walking, FindsTheFirstOffenceFromBothSides) {
    EXPECT_EQ(session->next_finding().reason, app::StopReason::found);
    const size_t offence = session->at();
    EXPECT_NE(next().result.verdict, core::Verdict::clear);
    for (size_t block = 0; block < offence; ++block)
        EXPECT_EQ(session->record().blocks[block].result.verdict, core::Verdict::clear);
    while (session->go_on().reason != app::StopReason::end) {
    }
    size_t first = session->at();
    while (session->previous_finding().reason == app::StopReason::found) first = session->at();
    EXPECT_EQ(first, offence);
}

/// The start position of the machine is unknown: a warning, but the block is not proven clear.
TEST(WalkingToAnOffence, StopsAtWhatIsNotDecidedAsWell) {
    const ProgramFiles files("lost.ngc",
                             "G21 G90 G54\nT1 M6\nG43 H1\nS2000 M3\nG0 X10\nG0 Z5\n"
                             "G1 Z-1 F200\nG1 X30\nG0 Z20\nM2\n",
                             walked_setup().program("dialect = \"linuxcnc\""));
    const auto opened = app::DebugSession::open(files.job());
    ASSERT_TRUE(opened);
    app::DebugSession& session = **opened;
    std::vector<size_t> before, after, back;
    const auto is_found = [](const app::Stop& stop) {
        return stop.reason == app::StopReason::found;
    };
    while (is_found(session.next_finding())) before.push_back(session.at());
    ASSERT_TRUE(session.is_recorded());
    const auto& blocks = session.record().blocks;
    ASSERT_FALSE(before.empty());
    EXPECT_EQ(blocks[before[0]].result.verdict, core::Verdict::undecided);
    while (is_found(session.previous_finding())) back.insert(back.begin(), session.at());
    while (is_found(session.next_finding())) after.push_back(session.at());
    EXPECT_EQ(back, before);
    EXPECT_EQ(after, before);
}

TEST_F(Walking, StopsAtARuleAToolAndACondition) {
    app::Breakpoint tool;
    tool.tool = core::ToolNumber{2};
    session->add(tool);
    ASSERT_EQ(session->go_on().reason, app::StopReason::breakpoint);
    EXPECT_EQ(next().result.tool, core::ToolNumber{2});
    EXPECT_TRUE(session->remove(session->breakpoints()[0].id));

    const auto near = app::Condition::read("clearance < 1 and feed");
    ASSERT_TRUE(near) << near.error().message;
    app::Breakpoint condition;
    condition.condition = *near;
    session->add(condition);
    while (session->go_on().reason == app::StopReason::breakpoint) {
        const auto& pairs = next().result.pairs;
        ASSERT_FALSE(pairs.empty());
        EXPECT_EQ(next().result.motion, core::BlockMotion::feed);
    }
}

TEST_F(Walking, WatchesAParameterBothWays) {
    ASSERT_TRUE(session->watch("#<_corners>"));
    std::vector<size_t> places;
    while (session->go_on().reason == app::StopReason::watch) places.push_back(session->at());
    EXPECT_GE(places.size(), 18U);
    EXPECT_EQ(session->watches()[0].hits, places.size());
    // Stepping back stops before the block that changes it.
    for (size_t i = places.size(); i-- > 0;) {
        ASSERT_EQ(session->reverse_resume().reason, app::StopReason::watch);
        EXPECT_EQ(session->at(), places[i] - 1);
    }
    EXPECT_EQ(session->reverse_resume().reason, app::StopReason::beginning);
}

TEST(BreakpointLines, MoveToTheNextLineThatHoldsABlock) {
    const ProgramFiles files("short.ngc", "%\n(first)\n\nG21 G90\n(second)\nM2\n%\n",
                             walked_setup());
    const auto session = app::DebugSession::open(files.job());
    ASSERT_TRUE(session);
    EXPECT_EQ((*session)->line_with_block(2).value_or(0), 4U);
    EXPECT_EQ((*session)->line_with_block(4).value_or(0), 4U);
    EXPECT_EQ((*session)->line_with_block(5).value_or(0), 6U);
    EXPECT_FALSE((*session)->line_with_block(7));
    EXPECT_FALSE((*session)->line_with_block(0));
    EXPECT_FALSE((*session)->line_with_block(70));
}

TEST_F(Walking, IgnoresABreakpointAsOftenAsRequested) {
    app::Breakpoint breakpoint;
    breakpoint.line = 13;
    breakpoint.ignore = 17;
    session->add(breakpoint);
    ASSERT_EQ(session->go_on().reason, app::StopReason::breakpoint);
    EXPECT_EQ(session->go_on().reason, app::StopReason::end);
}

TEST_F(Walking, EndsAtOnceOnRequest) {
    int asked = 0;
    session->is_interrupted = [&asked] { return ++asked == 2; };
    EXPECT_EQ(session->go_on().reason, app::StopReason::interrupted);
    EXPECT_GT(session->at(), 0U);
    EXPECT_FALSE(session->is_recorded());
}

TEST_F(Walking, RefusesABlockAfterTheEndAndStaysAtTheCurrentOne) {
    ASSERT_TRUE(session->go_to(17));
    EXPECT_FALSE(session->go_to(100'000));
    EXPECT_EQ(session->at(), 17U);
    EXPECT_TRUE(session->is_recorded());
}

TEST(WalkingToAnError, EndsWhereTheControlStops) {
    const ProgramFiles files("broken.ngc", "G21 G90 G54\nT1 M6\nG43 H1\nG0 X1 Y1\nG0 Z50\nG1 X3\n",
                             walked_setup());
    auto session = app::DebugSession::open(files.job());
    ASSERT_TRUE(session);
    EXPECT_EQ((*session)->go_on().reason, app::StopReason::error);
    const size_t end = (*session)->at();
    EXPECT_EQ((*session)->go_on().reason, app::StopReason::error);
    EXPECT_EQ((*session)->at(), end);
    (*session)->step_back();
    EXPECT_EQ((*session)->at(), end - 1);
    EXPECT_TRUE((*session)->record().stopped);
}

TEST_F(Walking, LetsNoBreakpointHideAnotherOneOfTheSameLine) {
    app::Breakpoint passing, stopping;
    passing.line = stopping.line = 13;
    passing.ignore = 5;
    session->add(passing);
    const int id = session->add(stopping);
    const app::Stop stop = session->go_on();
    EXPECT_EQ(stop.reason, app::StopReason::breakpoint);
    EXPECT_EQ(stop.id, id);
    EXPECT_EQ(next().line, 13U);
    EXPECT_EQ(session->breakpoints()[0].ignore, 4U);
}

TEST_F(Walking, StaysWhereItIsForNoStepsAtAll) {
    ASSERT_TRUE(session->go_to(40));
    session->step(0);
    EXPECT_EQ(session->at(), 40U);
    session->step_back(0);
    EXPECT_EQ(session->at(), 40U);
    session->next(0);
    EXPECT_EQ(session->at(), 40U);
    session->next_back(0);
    EXPECT_EQ(session->at(), 40U);
}

TEST_F(Walking, GivesUpADistantGoalOnRequest) {
    int asked = 0;
    session->is_interrupted = [&asked] { return ++asked == 10; };
    EXPECT_FALSE(session->reaches(1'000'000));
    EXPECT_FALSE(session->is_recorded());
    asked = 0;
    EXPECT_FALSE(session->find_line("43")); // M2
    EXPECT_FALSE(session->is_recorded());
    EXPECT_EQ(session->at(), 0U);
}

TEST(WalkingToAnError, FindsTheBlockOfAnAlarm) {
    const ProgramFiles files("broken.ngc", "G21 G90 G54\nT1 M6\nG43 H1\nG0 X1 Y1\nG0 Z50\nG1 X3\n",
                             walked_setup());
    auto opened = app::DebugSession::open(files.job());
    ASSERT_TRUE(opened);
    app::DebugSession& session = **opened;
    EXPECT_EQ(session.next_finding().reason, app::StopReason::found);
    const size_t alarm = session.at();
    EXPECT_EQ(session.record().blocks[alarm].line, 6U);
    EXPECT_EQ(session.next_finding().reason, app::StopReason::error);
    ASSERT_TRUE(session.go_to(0));
    EXPECT_EQ(session.until(*app::Condition::read("line = 6")).reason, app::StopReason::found);
    EXPECT_EQ(session.at(), alarm);
    ASSERT_TRUE(session.go_to(0));
    app::Breakpoint breakpoint;
    breakpoint.line = 6;
    session.add(breakpoint);
    EXPECT_EQ(session.go_on().reason, app::StopReason::breakpoint);
    EXPECT_EQ(session.go_on().reason, app::StopReason::error);
    EXPECT_EQ(session.at(), alarm);
    ASSERT_TRUE(session.go_to(2));
    EXPECT_EQ(session.next_tool().reason, app::StopReason::breakpoint) << "it changes no tool";
}

} // namespace
} // namespace session_test

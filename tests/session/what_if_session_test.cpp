#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/run_state.h"
#include "app/debug/debug_session.h"
#include "tests/session/walked_program.h"

namespace session_test {
namespace {

std::unique_ptr<app::DebugSession> open_session(const ProgramFiles& files) {
    auto opened = app::DebugSession::open(files.job());
    EXPECT_TRUE(opened) << opened.error().message;
    return opened ? *std::move(opened) : nullptr;
}

void record_all(app::DebugSession& session) {
    while (session.record_for(1.0)) {
    }
}

const app::WhatIf longer_tool = app::ToolLengthChange{core::ToolNumber{2}, 99.0};
const app::WhatIf moved_clamp = app::MovedFixture{"clamp-1", core::Vec3(-30.0, 0.0, 0.0)};
const app::WhatIf more_room = app::AllowanceChange{7.0};

TEST(WhatIf, ChangedAtTheBeginningIsAnotherSetup) {
    const ProgramFiles files("walked.ngc", walked_program(), walked_setup());
    const auto session = open_session(files);
    ASSERT_TRUE(session->change(more_room));
    record_all(*session);

    app::CheckJob job = files.job();
    job.allowance = 7.0;
    const auto other = app::run_check(job);
    ASSERT_TRUE(other);
    EXPECT_EQ(report_before(session->record(), 1'000'000), report_before(*other, 1'000'000));
}

TEST(WhatIf, LeavesEverythingBeforeItUntouched) {
    const ProgramFiles files("walked.ngc", walked_program(), walked_setup());
    const auto whole = app::run_check(files.job());
    ASSERT_TRUE(whole);
    const auto digests = digests_of(files.job());
    const auto session = open_session(files);
    record_all(*session);
    std::mt19937 random(4);
    for (const app::WhatIf& change : {longer_tool, moved_clamp, more_room}) {
        const size_t place = 100 + random() % 150;
        ASSERT_TRUE(session->go_to(place));
        ASSERT_TRUE(session->change(change));
        record_all(*session);
        // The last blocks before it may end slightly earlier or later if the next motion changes;
        // they are not compared.
        EXPECT_EQ(report_before(session->record(), place - 60), report_before(*whole, place - 60));
        const size_t before = random() % (place - 60);
        ASSERT_TRUE(session->go_to(before));
        EXPECT_EQ(app::digest_of(session->state()), digests[before]);
        ASSERT_TRUE(session->take_back());
        EXPECT_EQ(session->at(), place);
    }
}

TEST(WhatIf, TakenBackGivesTheRecordAsItWas) {
    const ProgramFiles files("walked.ngc", walked_program(), walked_setup());
    const auto whole = app::run_check(files.job());
    ASSERT_TRUE(whole);
    const auto session = open_session(files);
    std::mt19937 random(5);
    for (int round = 0; round < 12; ++round) {
        const std::array changes = {longer_tool, moved_clamp, more_room};
        ASSERT_TRUE(session->go_to(random() % 300));
        ASSERT_TRUE(session->change(changes[random() % 3]));
        if (random() % 2 == 0) record_all(*session);
        session->step(random() % 20);
        ASSERT_TRUE(session->change(changes[random() % 3]));
        session->step(random() % 50);
        ASSERT_TRUE(session->take_back());
        ASSERT_TRUE(session->take_back());
        record_all(*session);
        ASSERT_EQ(report_of(session->record()), report_of(*whole)) << round;
    }
}

TEST(WhatIf, MovesTheClampIntoTheWayOrOutOfIt) {
    const ProgramFiles files("walked.ngc", walked_program(), walked_setup());
    const auto session = open_session(files);
    record_all(*session);
    EXPECT_EQ(session->record().verdict, core::Verdict::collision);
    ASSERT_TRUE(session->go_to(200));
    ASSERT_TRUE(session->change(app::MovedFixture{"clamp-1", core::Vec3(40.0, 0.0, 0.0)}));
    record_all(*session);
    EXPECT_EQ(session->record().verdict, core::Verdict::clear);
}

TEST(WhatIf, IsTheSameByAnyRouteToALaterBlock) {
    const ProgramFiles files("walked.ngc", walked_program(), walked_setup());
    const auto session = open_session(files);
    ASSERT_TRUE(session->go_to(150));
    ASSERT_TRUE(session->change(longer_tool));
    std::vector<uint64_t> digests;
    for (size_t place = 150; place < 320; ++place) {
        ASSERT_TRUE(session->go_to(place));
        digests.push_back(app::digest_of(session->state()));
    }
    std::mt19937 random(6);
    for (int i = 0; i < 300; ++i) {
        const size_t place = 100 + random() % 220;
        ASSERT_TRUE(session->go_to(place));
        if (place < 150) continue;
        ASSERT_EQ(app::digest_of(session->state()), digests[place - 150]);
    }
}

TEST(WhatIf, TakenBackAtOnceLeavesNothing) {
    const ProgramFiles files("walked.ngc", walked_program(), walked_setup());
    const auto whole = app::run_check(files.job());
    ASSERT_TRUE(whole);
    const auto digests = digests_of(files.job());
    const auto session = open_session(files);
    for (const size_t place : {size_t(0), size_t(6), size_t(200)}) {
        ASSERT_TRUE(session->go_to(place));
        for (const app::WhatIf& change :
             {app::WhatIf(app::LengthOffsetOverride{core::OffsetNumber{1}, 60.0}),
              app::WhatIf(app::WorkOffsetChange{0, 2, -400.0}), longer_tool}) {
            ASSERT_TRUE(session->change(change));
            ASSERT_TRUE(session->take_back());
            ASSERT_EQ(app::digest_of(session->state()), digests[place]) << app::text_of(change);
        }
    }
    record_all(*session);
    EXPECT_EQ(report_of(session->record()), report_of(*whole));
}

TEST(WhatIf, OfAVastAllowanceLooksAsFarAsACheckDoes) {
    const ProgramFiles files("walked.ngc", walked_program(), walked_setup());
    const auto session = open_session(files);
    ASSERT_TRUE(session->change(app::AllowanceChange{80.0}));
    record_all(*session);
    app::CheckJob job = files.job();
    job.allowance = 80.0;
    const auto other = app::run_check(job);
    ASSERT_TRUE(other);
    ASSERT_EQ(session->record().blocks.size(), other->blocks.size());
    for (size_t i = 0; i < other->blocks.size(); ++i)
        EXPECT_EQ(session->record().blocks[i].result.verdict, other->blocks[i].result.verdict) << i;
    const auto text_of = [](const core::Finding& finding) { return finding.message; };
    std::vector<std::string> shown_assumptions, expected;
    std::ranges::transform(session->record().findings, std::back_inserter(shown_assumptions),
                           text_of);
    std::ranges::transform(other->findings, std::back_inserter(expected), text_of);
    EXPECT_EQ(shown_assumptions, expected);
}

const char* const moved_by_program = R"(G21 G90 G17 G54
T1 M6
G43 H1
S2000 M3
G0 Z60
M110
G0 X10 Y50
G0 Z5
G1 Z-2 F300
G1 X95
G0 Z60
M2
)";

/// If a pair was not measured, its distance is unknown, even if the search limit is lowered
/// afterwards.
TEST(WhatIf, OfASmallAllowanceLooksAsFarAsBefore) {
    const ProgramFiles files("walked.ngc", walked_program(), walked_setup());
    app::CheckJob job = files.job();
    job.allowance = 80.0;
    const auto opened = app::DebugSession::open(job);
    ASSERT_TRUE(opened);
    ASSERT_TRUE((*opened)->change(app::AllowanceChange{1.0}));
    EXPECT_EQ((*opened)->setup_at(0).search_limit, 81.0);
}

TEST(WhatIf, MovesAFixtureFromWhereTheProgramHasPutIt) {
    const ProgramFiles files(
        "moved.nc", moved_by_program,
        walked_setup().fixture("vise", "box = [[170, 40, -30], [180, 60, 40]]\n"
                                       "[[fixture.move]]\ncode = \"M110\"\nat = [0, 10, 0]\n"));
    const auto session = open_session(files);
    record_all(*session);
    ASSERT_EQ(session->record().verdict, core::Verdict::clear);
    ASSERT_TRUE(session->go_to(*session->find_line("7")));
    ASSERT_TRUE(session->change(app::MovedFixture{"vise", core::Vec3(-80.0, 0.0, 0.0)}));
    record_all(*session);
    EXPECT_EQ(session->record().verdict, core::Verdict::collision);
}

TEST(WhatIf, RefusesToMoveAFixtureThatHasBeenTakenAway) {
    const ProgramFiles files(
        "moved.nc", moved_by_program,
        walked_setup().fixture("vise", "box = [[170, 40, -30], [180, 60, 40]]\n"
                                       "[[fixture.move]]\ncode = \"M110\"\nremove = true\n"));
    const auto session = open_session(files);
    const app::MovedFixture change{"vise", core::Vec3(-80.0, 0.0, 0.0)};
    ASSERT_TRUE(session->go_to(*session->find_line("7")));
    const auto done = session->change(change);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().message, "vise was removed from the machine before this block");
    ASSERT_TRUE(session->go_to(*session->find_line("5")));
    EXPECT_TRUE(session->change(change));
}

/// The length in the control is 30 mm too short from G43 on. Meanwhile the clamp is moved into the
/// path.
TEST(WhatIf, LetsAWrongLengthAbsorbOnlyItsConsequences) {
    const ProgramFiles files("short.nc",
                             "G21 G90 G17 G54\nT1 M6\nS2000 M3\nG43 H3\nG0 Z90\nG0 X10 Y50\n"
                             "G1 Z-2 F500\nG1 X95\nG0 Z90\nM2\n",
                             walked_setup()
                                 .lengths("[[length_offset]]\nnumber = 3\nlength = 65.0\n")
                                 .fixture("post", "box = [[150, 40, -30], [160, 60, 60]]\n"));
    const auto session = open_session(files);
    ASSERT_TRUE(session->go_to(*session->find_line("7")));
    ASSERT_TRUE(session->change(app::MovedFixture{"post", core::Vec3(-80.0, 0.0, 0.0)}));
    record_all(*session);
    const auto shown_assumptions = [&](const core::Finding& finding) {
        return finding.pair[1] == "post";
    };
    const auto& findings = session->record().findings;
    EXPECT_TRUE(std::any_of(findings.begin(), findings.end(), shown_assumptions));
    const auto& combined_findings = session->record().combined_findings;
    EXPECT_TRUE(
        std::none_of(combined_findings.begin(), combined_findings.end(), shown_assumptions));
}

} // namespace
} // namespace session_test

#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/debug/debug_session.h"
#include "app/view/model/scene_of.h"
#include "app/view/model/session_worker.h"
#include "app/view/model/view_model.h"
#include "tests/support/scoped_folder.h"

namespace {

using namespace app::viewer;

/// A session on a program of its own, and what a window is told of it.
struct Published {
    test_support::ScopedFolder folder;
    std::unique_ptr<app::DebugSession> session;
    SessionPublisher publisher;
    ViewModel model;

    explicit Published(const std::string& text) {
        app::CheckJob job;
        job.program = folder.write("p.nc", text);
        auto opened = app::DebugSession::open(job);
        EXPECT_TRUE(opened) << opened.error().message;
        if (opened) session = *std::move(opened);
        publisher.begin({}, 0);
    }
    void publish() {
        SessionUpdate news;
        publisher.publish(*session, news);
        take_in(model, std::move(news), 0.0);
    }
    void record_all() {
        while (session->record_for(1.0)) {
        }
        publish();
    }
    /// That every row is the one of the record.
    void expect_rows_of_the_record() const {
        const auto& blocks = session->record().blocks;
        ASSERT_EQ(model.rows.size(), blocks.size());
        for (size_t i = 0; i < blocks.size(); ++i) {
            const BlockRow row = row_of(session->setup_at(i), blocks[i]);
            ASSERT_EQ(model.rows[i].duration, row.duration) << i;
            ASSERT_EQ(model.rows[i].time, row.time) << i;
            ASSERT_EQ(model.rows[i].lower, row.lower) << i;
            ASSERT_EQ(model.rows[i].verdict, row.verdict) << i;
        }
    }
};

const std::string opening = "G21 G90 G17 G54\nT1 M6\nG43 H1\nS2000 M3\nG0 X0 Y0 Z50\nG0 Z2\n";

/// A motion's time is known when many more have come, however many blocks stand between them.
TEST(SessionPublisher, PublishesTimesThatAreSettledLate) {
    std::string text = opening + "G1 Z-1 F600\n";
    for (int i = 0; i < 600; ++i) {
        text += i % 2 == 0 ? "X10\n" : "X0\n";
        for (int j = 0; j < 4; ++j) text += "(nothing)\nM9\n";
    }
    Published program(text + "G0 Z50\nM30\n");
    for (size_t block = 100; program.session->knows(block); block += 100) program.publish();
    program.record_all();
    ASSERT_GT(program.model.rows.size(), 2500U);
    program.expect_rows_of_the_record();
}

/// What was searched for within 20 mm is not known to be 80 mm away.
TEST(SessionPublisher, ClaimsNoMoreThanWasLookedForWhenABlockWasRun) {
    Published program(opening + "G0 Z90\nG0 X5\nG0 X0\nG1 Z-1 F200\nX20\nG0 Z90\nG0 X5\nM30\n");
    ASSERT_TRUE(program.session->go_to(9));
    const double looked_for = program.session->setup_at(0).search_limit;
    ASSERT_TRUE(program.session->change(app::AllowanceChange{80.0}));
    program.record_all();
    EXPECT_EQ(program.model.rows.at(7).lower, looked_for);
    EXPECT_EQ(program.model.rows.at(12).lower, 81.0);
    program.expect_rows_of_the_record();
}

/// Errors are painted, other findings are not.
TEST(SessionPublisher, PaintsThePathAsTheRowsAre) {
    Published program(
        opening + "G1 Z-1 F200\nX20 (feeler: allow no-such)\nG0 X30\nG0 Z50\nG1 X60 F200\nM30\n");
    std::vector<render::PathPoint> points;
    for (uint32_t block = 0; block < 11; ++block)
        points.push_back({glm::vec3(static_cast<float>(block)), block});
    program.publisher.begin(points, 11);
    program.record_all();
    ASSERT_TRUE(program.model.path);
    size_t shown_assumptions = 0, failed = 0;
    for (const render::PathPoint& point : program.model.path->points) {
        const BlockRow& row = program.model.rows[point.block];
        EXPECT_EQ(point.state, state_of(row)) << point.block << " " << row.text;
        const bool is_reported =
            row.worst > core::Severity::off && row.worst < core::Severity::error;
        if (is_reported && !is_offending(row)) ++shown_assumptions;
        if (row.worst == core::Severity::error) ++failed;
    }
    EXPECT_GT(shown_assumptions, 0U);
    EXPECT_GT(failed, 0U);
}

} // namespace
